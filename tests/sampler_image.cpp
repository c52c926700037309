// Renders with Sobol points against closed forms, judged by the standard error that the film promises.
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double albedo = 0.5;
constexpr double pi = glm::pi<double>();

struct Known {
  const char* name;
  World world;
  double radiance;  // of every pixel
};

// A diffuse floor around the origin, facing +z, whose origin the camera sees.
World plate() {
  World world;
  add_quad(add_shape(world, diffuse(albedo), Sides::front).mesh, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0});
  look_closely(world, {0.3, 0.4, 0.6}, {0, 0, 0});
  world.integrator.max_depth = 2;
  return world;
}

// Form factor of a point to a rectangle a x b parallel to it at distance 1, one corner straight above it (Howell, Menguc,
// Daun, Siegel 2020, appendix C).
double corner_factor(double a, double b) {
  const double x = std::sqrt(1.0 + a * a), y = std::sqrt(1.0 + b * b);
  return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2.0 * pi);
}

World under_rectangle() {
  World world = plate();
  add_quad(add_black(world, glm::dvec3(1.0)).mesh, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  return world;
}

World under_sphere() {
  World world = plate();
  WorldShape& light = add_black(world, glm::dvec3(1.0));
  light.geometry = Geometry::sphere;
  light.to_world = glm::dmat4(0.5);
  light.to_world[3] = {std::sqrt(3.0), 0, 1, 1};
  return world;
}

// A white sky, much of one half of it behind a sheet that lets 3/4 through.
World under_sheet() {
  World world = plate();
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  Material sheet = diffuse(0.0);
  sheet.transparency = 0.75f;
  add_quad(add_shape(world, sheet, Sides::both).mesh, {0, -2, 1}, {2, 0, 0}, {0, 4, 0});
  return world;
}

// Walls that emit 1 and reflect half of it, over five segments.
World room() {
  World world;
  add_box(add_shape(world, diffuse(albedo), Sides::front, 1.0).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  look(world, {0.1, 0.2, 0.3}, {1, 0.5, 0.2}, {0, 1, 0}, 1.0, 32, 16);
  world.integrator.max_depth = 5;
  return world;
}

// A lamp fills one half of the picture, out of focus.
World lamp_behind_a_lens() {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(0.25));
  add_quad(add_black(world, glm::dvec3(1.0)).mesh, {-100, -100, 3}, {0, 200, 0}, {100, 0, 0});
  look(world, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.5, 33, 16);
  world.camera.aperture_radius = 0.1;
  world.camera.focus_distance = 1.0;
  return world;
}

std::vector<Known> known() {
  const double white = (1.0 - std::pow(albedo, 5)) / (1.0 - albedo);
  return {{"rectangle", under_rectangle(), albedo * corner_factor(1, 1)},
          {"sphere", under_sphere(), albedo * 0.0625 * 0.5},
          {"sheet", under_sheet(), albedo * (1.0 - 0.25 * 2.0 * corner_factor(2, 2))},
          {"room", room(), white}};
}

Film render_sampled(World world, SamplerKind sampler, uint samples) {
  world.sampler = sampler;
  return render_full(world, samples);
}

// Sums over pixels of the squared errors of the means, of the squared standard errors, and of the squares of what these
// differ by.
struct Squares {
  double errors = 0.0, promised = 0.0, fourth = 0.0;
};

Squares squares(const Film& film, double radiance) {
  Squares sum;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double error = pixel_mean(film, i)[0] - radiance, promise = (*pixel_standard_error(film, i))[0];
    sum.errors += error * error;
    sum.promised += promise * promise;
    sum.fourth += std::pow(error * error - promise * promise, 2.0);
  }
  return sum;
}

}  // namespace

TEST(sampler_image, sobol_points_give_the_known_radiance_within_the_promised_error) {
  for (const Known& k : known()) {
    SCOPED_TRACE(k.name);
    const Film film = render_sampled(k.world, SAMPLER_SOBOL, 16 * REPLICA_SAMPLES);
    EXPECT_EQ(rejected_samples(film), 0u);
    double mean = 0.0;
    const double pixels = static_cast<double>(film.pixels.size());
    for (std::size_t i = 0; i < film.pixels.size(); ++i) mean += pixel_mean(film, i)[0] / pixels;
    const double error = std::sqrt(squares(film, k.radiance).promised) / pixels;
    EXPECT_NEAR(mean, k.radiance, z_bound(4) * error + 64 * unit_roundoff * k.radiance)
        << "z = " << (mean - k.radiance) / error;
    EXPECT_LE(z_power * error, 0.005 * k.radiance) << "too few samples";
  }
}

// Both sums have the same expectation, whatever the distribution of a replica: of their difference, of independent terms, the
// deviation is estimated from the terms.
TEST(sampler_image, promised_errors_are_the_errors_from_the_known_radiance) {
  for (const SamplerKind sampler : {SAMPLER_INDEPENDENT, SAMPLER_SOBOL})
    for (const Known& k : known()) {
      SCOPED_TRACE(testing::Message() << k.name << " " << sampler);
      const Squares sum = squares(render_sampled(k.world, sampler, 16 * REPLICA_SAMPLES), k.radiance);
      EXPECT_NEAR(sum.errors, sum.promised, z_bound(8) * std::sqrt(sum.fourth));
      EXPECT_LE(z_bound(8) * std::sqrt(sum.fourth), 0.5 * sum.promised)
          << "too few samples to find a variance that is half off";
    }
}

// On a smooth integrand in two dimensions a net of 16 points leaves far less variance than 16 independent ones; where
// something is decided besides, less but some.
TEST(sampler_image, sobol_points_leave_less_error_than_independent_ones) {
  for (const Known& k : known()) {
    SCOPED_TRACE(k.name);
    const Squares sobol = squares(render_sampled(k.world, SAMPLER_SOBOL, 16 * REPLICA_SAMPLES), k.radiance);
    const Squares independent = squares(render_sampled(k.world, SAMPLER_INDEPENDENT, 16 * REPLICA_SAMPLES), k.radiance);
    const double most = sobol.promised + z_bound(8) * std::sqrt(sobol.fourth);
    EXPECT_LT(most, independent.promised - z_bound(8) * std::sqrt(independent.fourth));
  }
}

// By symmetry the picture's mean is that of lamp and sky.
TEST(sampler_image, sobol_points_on_film_and_lens_leave_the_pictures_mean) {
  const Film film = render_sampled(lamp_behind_a_lens(), SAMPLER_SOBOL, 16 * REPLICA_SAMPLES);
  const Film plain = render_sampled(lamp_behind_a_lens(), SAMPLER_INDEPENDENT, 16 * REPLICA_SAMPLES);
  const auto mean = [](const Film& f) {
    Estimate e{};
    const double pixels = static_cast<double>(f.pixels.size());
    for (std::size_t i = 0; i < f.pixels.size(); ++i) {
      e.mean += pixel_mean(f, i)[0] / pixels;
      e.error += std::pow((*pixel_standard_error(f, i))[0] / pixels, 2.0);
    }
    return Estimate{e.mean, std::sqrt(e.error)};
  };
  const Estimate sobol = mean(film);
  EXPECT_NEAR(sobol.mean, 0.5 * (0.25 + 1.0), z_bound(2) * sobol.error + 64 * unit_roundoff);
  // Were the two alike, the differences of their estimated variances would be independent terms around 0.
  double gain = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double difference =
        std::pow((*pixel_standard_error(plain, i))[0], 2.0) - std::pow((*pixel_standard_error(film, i))[0], 2.0);
    gain += difference;
    squares += difference * difference;
  }
  EXPECT_GT(gain, z_bound(2) * std::sqrt(squares));
}
