// The film's filters: a constant stays constant, an edge becomes the filter's integral.
#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Filter {
  FilterKind kind;
  double radius;
};
constexpr Filter filters[] = {{FilterKind::box, 0.5}, {FilterKind::tent, 1.0}, {FilterKind::gaussian, 2.0}};
constexpr double stddev = 0.5;

void set_filter(World& world, Filter filter, bool border) {
  world.film.filter = filter.kind;
  world.film.filter_radius = filter.radius;
  world.film.filter_stddev = stddev;
  world.film.sample_border = border;
}

// Integral of the filter up to x, not normalised: constant; radius - |x|; Gaussian less its value at the radius.
double integral(Filter filter, double x) {
  x = std::clamp(x, -filter.radius, filter.radius);
  switch (filter.kind) {
    case FilterKind::box: return x + filter.radius;
    case FilterKind::tent: return x < 0 ? 0.5 * std::pow(x + filter.radius, 2) : filter.radius * filter.radius - 0.5 * std::pow(filter.radius - x, 2);
    default: {
      const auto half = [&](double y) { return stddev * std::sqrt(0.5 * glm::pi<double>()) * std::erf(y / (stddev * std::sqrt(2.0))); };
      return half(x) + half(filter.radius) - std::exp(-0.5 * std::pow(filter.radius / stddev, 2)) * (x + filter.radius);
    }
  }
}

// Looks along -z from height 1 at [-width, width] x [-height, height] / 16, +x to the right and +y up.
void look_down(World& world, uint width, uint height) { look(world, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, width / 16.0, width, height); }

// A lamp that fills the rectangle of the film between two corners, in pixels.
void add_lamp(World& world, uint width, uint height, glm::dvec2 low, glm::dvec2 high) {
  const auto place = [&](glm::dvec2 p) { return glm::dvec3((p.x - 0.5 * width) / 8.0, (0.5 * height - p.y) / 8.0, 0); };
  const glm::dvec3 a = place(low), b = place(high);
  add_quad(add_black(world, glm::dvec3(1.0)).mesh, {a.x, b.y, 0}, {b.x - a.x, 0, 0}, {0, a.y - b.y, 0});
}

}  // namespace

TEST(filter_image, constant_scene_is_constant) {
  double worst = 0.0;
  for (const Filter filter : filters)
    for (const bool border : {false, true}) {
      World world;
      add_light(world, LIGHT_CONSTANT, glm::dvec3(0.7));
      look_down(world, 12, 9);
      set_filter(world, filter, border);
      for (const bool crop : {false, true}) {
        if (crop) {
          world.film.crop_x = 3;
          world.film.crop_y = 2;
          world.film.crop_width = 5;
          world.film.crop_height = 4;
        }
        worst = std::max(worst, expect_every_sample(render_full(world, 64), 0.7f, 2 * unit_roundoff));
      }
    }
  record_extreme("X49", worst / unit_roundoff, 2);
}

// A lamp that covers the crop window to 1e-4 of a pixel: all samples see it unless the border is sampled too.
TEST(filter_image, samples_stay_inside_the_crop_window_without_sample_border) {
  for (const Filter filter : filters)
    for (const bool border : {false, true}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(filter.kind) << " " << border);
      World world;
      look_down(world, 12, 9);
      set_filter(world, filter, border);
      world.film.crop_x = 3;
      world.film.crop_y = 2;
      world.film.crop_width = 5;
      world.film.crop_height = 4;
      add_lamp(world, 12, 9, glm::dvec2(3, 2) - 1e-4, glm::dvec2(8, 6) + 1e-4);
      const Film film = render_full(world, 1024);
      if (!border || filter.kind == FilterKind::box) expect_every_sample(film, 1.0, 0.0);
      else {
        EXPECT_LT(pixel_mean(film, 0)[0], 0.99);
        EXPECT_EQ(pixel_mean(film, 5 * 1 + 2)[0] == 1.0, filter.kind == FilterKind::tent);  // the second pixel from the edge
      }
    }
}

// Bright from position 4.3 on, to the right or downwards: a pixel at c has the filter's share beyond 4.3 - c, of what the film's edge
// leaves of the filter. 100 judgements: 5 deviations are 6e-5 for all.
TEST(filter_image, edge_becomes_the_integral_of_the_filter) {
  const uint across = 9, along = 16, samples = 12000;
  const double edge = 4.3;
  for (const Filter filter : filters)
    for (const bool border : {false, true})
      for (const bool vertical : {false, true}) {
        SCOPED_TRACE(testing::Message() << static_cast<int>(filter.kind) << " " << border << " " << vertical);
        World world;
        const uint width = vertical ? across : along, height = vertical ? along : across;
        look_down(world, width, height);
        set_filter(world, filter, border);
        add_lamp(world, width, height, vertical ? glm::dvec2(edge, -9) : glm::dvec2(-9, edge), {99, 99});
        const Film film = render_full(world, samples);
        for (uint i = 0; i < across; ++i) {
          double mean = 0.0;
          for (uint j = 0; j < along; ++j) mean += pixel_mean(film, vertical ? j * across + i : i * along + j)[0] / along;
          const double center = i + 0.5;
          const double low = border ? -filter.radius : -center, high = border ? filter.radius : across - center;
          const double whole = integral(filter, high) - integral(filter, low);
          const double exact = (integral(filter, high) - integral(filter, std::clamp(edge - center, low, high))) / whole;
          const double error = std::sqrt(exact * (1.0 - exact) / (samples * along));
          // 3e-5: the Gaussian's table.
          EXPECT_NEAR(mean, exact, 5.0 * error + (filter.kind == FilterKind::gaussian ? 3e-5 : 1e-6)) << i;
        }
      }
}
