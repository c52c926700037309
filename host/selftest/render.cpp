#include "../render.h"

#include <cstring>

#include "../film.h"
#include "groups.h"
#include "meshes.h"

namespace oclair::selftest {
namespace {

constexpr uint width = 32, height = 16, samples = 64;
constexpr double albedo = 0.5;

// A closed cube whose walls emit 1 and reflect half of what falls on them, seen from inside.
World furnace() {
  World world;
  Material wall{};
  wall.kind = MATERIAL_DIFFUSE;
  wall.reflectance = {albedo, albedo, albedo};
  world.materials.push_back(wall);
  WorldShape& shape = world.shapes.emplace_back();
  add_box(shape.mesh, {-1, -1, -1}, {1, 1, 1}, true);
  shape.material_front = 0;
  shape.radiance = glm::dvec3(1.0);
  const glm::dvec3 from(0.1, 0.2, 0.3), z = glm::normalize(glm::dvec3(1, 0.5, 0.2) - from),
                                        x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), z));
  world.camera.to_world =
      glm::dmat4(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(from, 1));
  world.film.width = world.film.crop_width = width;
  world.film.height = world.film.crop_height = height;
  return world;
}

Film rendered(const Device& device, const Scene& scene, const Bvh& bvh, const std::vector<uint>& passes) {
  Renderer renderer = start_render(device, scene, bvh);
  for (const uint pass : passes) render_pass(renderer, pass);
  return read_film(renderer);
}

}  // namespace

// Every point of the room shines with 1/(1 - albedo) in every direction (an integrating sphere of any shape), so the pixels
// differ by noise alone, and their mean is off by more than 4.27 standard errors with a probability of 2e-5. A standard error of
// 0.002 of the mean finds a bias of 1.1 % nine times in ten (5.55 of them). Sums are exact: the same samples in other passes give
// the same bits.
void check_render(const Session& session, Group& group) {
  const Scene scene = place_scene(furnace());
  const Bvh bvh = build_bvh(scene, session.device.bvh_width);
  const Film film = rendered(session.device, scene, bvh, {samples}),
             split = rendered(session.device, scene, bvh, {samples / 2 - 5, 1, samples / 2 + 4});
  double sum = 0, squares = 0;
  std::size_t different = 0, rejected = 0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double value = pixel_mean(film, i)[0];
    sum += value;
    squares += value * value;
    rejected += film.pixels[i].rejected;
    different += std::memcmp(&film.pixels[i], &split.pixels[i], sizeof(FilmPixel)) != 0 ||
                 std::memcmp(&film.errors[i], &split.errors[i], sizeof(FilmErrors)) != 0;
  }
  const double n = static_cast<double>(film.pixels.size()), mean = sum / n,
               error = std::sqrt((squares / n - mean * mean) / (n - 1));
  group.measure("mean", mean);
  group.bound("standard errors off 2", std::abs(mean - 1 / (1 - albedo)) / error, 4.27);
  group.bound("relative error", error / mean, 0.002);
  group.bound("samples rejected", static_cast<double>(rejected), 0);
  group.bound("pixels that depend on the passes", static_cast<double>(different), 0);
}

}  // namespace oclair::selftest
