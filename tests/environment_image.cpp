// Renders under environment maps and textured lights: seen directly, on a plane, in a furnace.
#include "environment_maps.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double albedo = 0.5;
constexpr double pi = glm::pi<double>();

// The image's +y, its zenith, becomes the world's +z.
const glm::dmat3 zenith_up(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, -1, 0));

WorldLight& add_map(World& world, std::shared_ptr<const Image> image, const glm::dmat3& rotation = zenith_up, double scale = 1.0) {
  WorldLight& light = add_light(world, LIGHT_ENVIRONMENT, glm::dvec3(scale));
  light.image = std::move(image);
  light.rotation = rotation;
  return light;
}

World floor_seen_from(glm::dvec3 from) {
  World world;
  add_quad(add_shape(world, diffuse(albedo), Sides::front).mesh, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0});
  look_closely(world, from, {0, 0, 0});
  world.integrator.max_depth = 2;
  return world;
}

// Irradiance from above of a map with zenith_up. The horizon lies between rows of cells if the number of rows of texels is odd.
double irradiance(const Image& image, double scale = 1.0) {
  double sum = 0;
  for (uint y = 0; y < (image.height - 1) / 2; ++y)
    for (uint x = 0; x < image.width; ++x)
      sum += integrate_cell(image, x, y, 16, [](const glm::dvec3& d, const glm::dvec3& rgb) { return d.y * rgb.x; });
  return scale * sum;
}

}  // namespace

TEST(environment_image, a_map_seen_directly_is_its_texels) {
  const auto image = random_image(16, 9, 3);
  for (const glm::dmat3& rotation : {glm::dmat3(1.0), zenith_up})
    for (const glm::dvec3& to : {glm::dvec3(1, 2, 3), {-3, 1, 0.5}, {0.2, -0.9, 1}, {-1, -0.1, -2}}) {
      World world;
      add_quad(add_black(world).mesh, {-1, -1, -1}, {1e-3, 0, 0}, {0, 1e-3, 0});
      const glm::dvec3 d = glm::normalize(to);
      look_closely(world, {0, 0, 0}, d);
      add_map(world, image, rotation, 2.0);
      const glm::dvec3 exact = 2.0 * map_value(*image, map_place(16, 9, glm::transpose(rotation) * d));
      const Film film = render_full(world, 4);
      // The view is 2e-5 wide, in which the value changes by up to its range, 10, in a cell of 2 pi / 16 times the sine of its row.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(estimate(film, c).mean, exact[c], 5e-3);
      EXPECT_GT(film.pixels[0].hits, 0u);
    }
}

TEST(environment_image, a_hidden_map_is_not_seen_but_shines) {
  World world = floor_seen_from({-0.3, -0.4, 0.5});
  add_map(world, random_image(8, 5, 1));
  world.integrator.hide_emitters = true;
  EXPECT_GT(estimate(render_full(world, 64)).mean, 0.0);
  look_closely(world, {-0.3, -0.4, 0.5}, {0, 0, 1});
  const Film film = render_full(world, 4);
  EXPECT_EQ(estimate(film).mean, 0.0);
  EXPECT_EQ(film.pixels[0].hits, 0u);
}

// rho L for every point of a convex body, whatever the rotation; and the same mean as under the constant light.
TEST(environment_image, a_map_of_one_value_is_a_furnace_like_the_constant_light) {
  for (const bool constant : {false, true}) {
    World world;
    add_sphere(world, diffuse(albedo), Sides::front, {0, 0, 0}, 1.0);
    if (constant) add_light(world, LIGHT_CONSTANT, glm::dvec3(3.0));
    else add_map(world, float_image(6, 4, [](uint, uint) { return glm::dvec3(1.5); }), zenith_up, 2.0);
    look_closely(world, {1.2, -1.5, 2.0}, {0.3, -0.2, 0.93});
    expect_mean(render_full(world, 512), albedo * 3.0);
  }
}

TEST(environment_image, irradiance_of_a_map_is_its_quadrature) {
  struct Case {
    const char* name;
    std::shared_ptr<const Image> image;
    uint samples;
  };
  for (const Case& c : {Case{"sun of one texel", sun_image(32, 17, 5, 3, 1e4), 600}, {"sun at the zenith", sun_image(32, 17, 5, 0, 1e4), 800},
                        {"sun on the seam", sun_image(32, 17, 31, 4, 1e4), 600}, {"noise", random_image(16, 9, 6), 1200},
                        {"gradient", float_image(16, 9, [](uint x, uint y) { return glm::dvec3(x + 2.0 * y); }), 1200}}) {
    SCOPED_TRACE(c.name);
    World world = floor_seen_from({-0.3, -0.4, 0.5});
    add_map(world, c.image);
    expect_mean(render_full(world, c.samples), albedo / pi * irradiance(*c.image), 0.01);
  }
}

// Beside a light a million times weaker or stronger the map stays right: selection and both densities count its probability.
TEST(environment_image, a_map_beside_another_light_adds_up) {
  const auto image = random_image(16, 9, 6);
  for (const double other : {0.1, 30.0}) {
    World world = floor_seen_from({-0.3, -0.4, 0.5});
    add_map(world, image);
    add_light(world, LIGHT_DIRECTIONAL, glm::dvec3(other), {0, 0, -1});
    expect_mean(render_full(world, 2000), albedo / pi * (irradiance(*image) + other), 0.01);
  }
}

// cos to the axis of a spot above, off its axis: E = I f cos / d^2; no noise.
TEST(environment_image, a_spot_lights_the_floor_by_its_falloff) {
  for (const double angle : {5.0, 17.5, 19.0, 25.0}) {
    World world = floor_seen_from({-0.5, -0.4, 0.6});
    const double tilt = glm::radians(angle), height = 2.0;
    WorldLight& light = add_light(world, LIGHT_SPOT, glm::dvec3(3.0), {0, 0.5, height});
    const glm::dvec3 down = glm::normalize(-light.position), across(1, 0, 0);
    light.axis = std::cos(tilt) * down + std::sin(tilt) * across;
    const double share = angle <= 15 ? 1.0 : std::max(0.0, (20.0 - angle) / 5.0), d2 = glm::dot(light.position, light.position);
    const double exact = albedo / pi * 3.0 * share * height / std::sqrt(d2) / d2;
    // The view is 2e-5 wide: angles change by 1e-5, of a ramp of .087.
    expect_every_sample(render_full(world, 4), exact, share == 1.0 ? 1e-4 : 1e-3);
  }
}

// A square light with a texture, seen from the floor: both strategies joined, against the sum over its tiles.
TEST(environment_image, a_textured_light_brings_the_sum_of_its_texels) {
  const auto image = float_image(4, 4, [](uint x, uint y) { return glm::dvec3((x + y) % 2 ? 0.0 : 1.0 + 3.0 * x + y); });
  for (const double height : {0.1, 0.5, 1.0}) {
    World world = floor_seen_from({0.3 * height, 0.2 * height, 0.6 * height});
    world.textures.emplace_back().image = image;
    world.textures[0].nearest = true;
    WorldShape& light = add_black(world, glm::dvec3(1.0));
    light.radiance_texture = 1;
    add_quad(light.mesh, {-0.5, -0.5, height}, {0, 1, 0}, {1, 0, 0});
    light.mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    double exact = 0;
    for (uint y = 0; y < 4; ++y)
      for (uint x = 0; x < 4; ++x)
        for (const Node& a : gauss_legendre(30, x / 4.0 - 0.5, (x + 1) / 4.0 - 0.5))
          for (const Node& b : gauss_legendre(30, y / 4.0 - 0.5, (y + 1) / 4.0 - 0.5)) {
            const double d2 = a.x * a.x + b.x * b.x + height * height;
            exact += a.weight * b.weight * texel_of(*image, x, y).x * height * height / (d2 * d2);
          }
    expect_mean(render_full(world, 1500), albedo / pi * exact, 0.01);
  }
}

// Seen directly each tile is its texel.
TEST(environment_image, a_textured_light_seen_directly_is_its_texels) {
  const auto image = random_image(3, 2, 5);
  for (uint x = 0; x < 3; ++x)
    for (uint y = 0; y < 2; ++y) {
      World world;
      world.textures.emplace_back().image = image;
      world.textures[0].nearest = true;
      WorldShape& light = add_black(world, glm::dvec3(1.0));
      light.radiance_texture = 1;
      add_quad(light.mesh, {0, 0, 0}, {3, 0, 0}, {0, 2, 0});
      light.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      look_closely(world, {1.5, 1.0, 3.0}, {x + 0.4, y + 0.3, 0});
      for (int c = 0; c < 3; ++c) expect_every_sample(render_full(world, 1), texel_of(*image, x, y)[c], 1e-6, c);
    }
}
