// Whole renders by the lens and by the orthographic camera against their closed forms.
#include <cstring>

#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;

// A disk light of radius `radius` and radiance 1 at depth `depth` on the axis of a camera that looks along +z from the
// origin.
World point_before_a_lens(double radius, double depth, double aperture, double focus, double tan_half_fov) {
  World world;
  WorldShape& light = add_black(world, glm::dvec3(1.0));
  light.geometry = Geometry::disk;
  light.to_world = glm::dmat4(glm::dvec4(radius, 0, 0, 0), glm::dvec4(0, -radius, 0, 0), glm::dvec4(0, 0, -radius, 0),
                              glm::dvec4(0, 0, depth, 1));
  look(world, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, tan_half_fov, 64, 64);
  world.integrator.max_depth = 1;
  world.camera.aperture_radius = aperture;
  world.camera.focus_distance = focus;
  return world;
}

// Distance from the axis of the nearest and farthest points of a pixel, in units of the light's plane.
std::pair<double, double> reach(std::size_t pixel, double half_width) {
  const double x = (static_cast<double>(pixel % 64) - 31.5) * half_width / 32.0,
               y = (static_cast<double>(pixel / 64) - 31.5) * half_width / 32.0;
  const double r = std::hypot(x, y), half_diagonal = half_width / 32.0 * std::sqrt(0.5);
  return {r - half_diagonal, r + half_diagonal};
}

}  // namespace

// A ray through the lens point p and the point X f of the plane in focus crosses the light's plane at X d + p (1 - d / f): a
// small light spreads over a disk of radius b = a |d - f| / f there. Where X d is less than b - r away from the axis the
// share of the lens that sees the light is (r / b)^2; beyond b + r it is 0.
TEST(lens_image, a_point_out_of_focus_is_a_disk_of_the_radius_of_the_thin_lens) {
  struct Row {
    double depth, focus, aperture;
  };
  for (const Row& row : {Row{2.0, 1.0, 0.05}, Row{2.0, 4.0, 0.1}, Row{1.0, 1000.0, 0.05}}) {
    const double blur = row.aperture * std::abs(row.depth - row.focus) / row.focus, radius = blur / 8.0;
    const double half_width = 1.5 * blur;
    const Film film =
        render_full(point_before_a_lens(radius, row.depth, row.aperture, row.focus, half_width / row.depth), 1024);
    EXPECT_EQ(rejected_samples(film), 0u);
    const double exact = radius * radius / (blur * blur);
    double sum = 0.0, all = 0.0, count = 0.0;
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
      const auto [nearest, farthest] = reach(i, half_width);
      const double mean = pixel_mean(film, i)[0];
      all += mean;
      if (nearest > (blur + radius) * 1.0001) {
        EXPECT_EQ(mean, 0.0) << i;
      }
      if (farthest < (blur - radius) * 0.9999) sum += mean, count += 1.0;
    }
    const auto expect_share = [&](double share, double of, double samples) {
      EXPECT_NEAR(share, of, z_limit * std::sqrt(of * (1.0 - of) / samples)) << row.depth << " " << row.focus;
    };
    expect_share(sum / count, exact, 1024.0 * count);
    // Nothing is lost: the light of the whole disk arrives on the film.
    expect_share(all / 4096.0, pi * radius * radius / (4.0 * half_width * half_width), 1024.0 * 4096.0);
  }
}

TEST(lens_image, what_is_in_focus_is_as_sharp_as_through_a_pinhole) {
  const double radius = 0.03, half_width = 0.05, depth = 2.0;
  const World open = point_before_a_lens(radius, depth, 0.2, depth, half_width / depth);
  const Film film = render_full(open, 64);
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const auto [nearest, farthest] = reach(i, half_width);
    if (nearest > radius * 1.0001) {
      EXPECT_EQ(pixel_mean(film, i)[0], 0.0) << i;
    } else if (farthest < radius * 0.9999) {
      EXPECT_EQ(pixel_mean(film, i)[0], 1.0) << i;
    }
  }
}

// The rectangle's edges are those of pixels: 24 x 10 of them, wherever the camera stands.
TEST(lens_image, an_orthographic_picture_of_a_rectangle_covers_its_pixels_and_no_others) {
  for (const double away : {0.5, 20.0, 1e6}) {
    World world;
    add_quad(add_black(world, glm::dvec3(1.0)).mesh, {-0.5, -0.25, 0.0}, {0, 0.625, 0}, {1.5, 0, 0});
    look(world, {0, 0, -away}, {0, 0, 0}, {0, 1, 0}, 2.0, 64, 32);
    world.camera.orthographic = true;
    world.camera.far_clip = 2e6;
    world.integrator.max_depth = 1;
    const Film film = render_full(world, 64);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
      const double mean = pixel_mean(film, i)[0];
      // +x is to the left: x from 1 to -0.5 is 16 to 40 pixels from the left; y from 0.375 to -0.25 is 10 to 20 from above.
      const bool inside = i % 64 >= 16 && i % 64 < 40 && i / 64 >= 10 && i / 64 < 20;
      EXPECT_EQ(mean, inside ? 1.0 : 0.0) << i;
      covered += mean > 0.0;
    }
    EXPECT_EQ(covered, 240u);
  }
}

TEST(lens_image, scaling_the_world_by_a_power_of_two_changes_no_pixel) {
  for (const bool orthographic : {false, true}) {
    Film films[2];
    for (const int i : {0, 1}) {
      const double scale = std::ldexp(1.0, 13 * i);
      World world;
      add_box(add_shape(world, diffuse(0.5), Sides::front).mesh, scale * glm::dvec3(-1), scale * glm::dvec3(1), true);
      add_quad(add_shape(world, diffuse(0.2), Sides::both, 3.0).mesh, scale * glm::dvec3(-0.25, 0.5, 0), {0.5 * scale, 0, 0},
               {0, 0, 0.5 * scale});
      look(world, scale * glm::dvec3(0, 0, -0.75), {0, 0, 0}, {0, 1, 0}, orthographic ? 0.5 * scale : 0.5, 32, 32);
      world.camera.orthographic = orthographic;
      world.camera.aperture_radius = orthographic ? 0.0 : 0.0625 * scale;
      world.camera.focus_distance = 0.5 * scale;
      world.camera.near_clip = 0.0078125 * scale;
      world.camera.far_clip = 8.0 * scale;
      films[i] = render_full(world, 8);
    }
    EXPECT_EQ(std::memcmp(films[0].pixels.data(), films[1].pixels.data(), films[0].pixels.size() * sizeof(FilmPixel)), 0)
        << orthographic;
  }
}
