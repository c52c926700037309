// Renders a scene: compiles its kernel, runs passes, keeps the film on the device.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "film_plan.h"

namespace oclair {

// The film as the device leaves it, row by row over the crop window.
struct Film {
  uint width = 0, height = 0;
  int exponent = 0;             // Settings::film_exponent
  std::uint64_t samples = 0;    // per pixel, rejected ones included
  FilmVector<FilmPixel> pixels;
  FilmVector<FilmMoments> moments;  // empty without FEATURE_MOMENTS
  FilmVector<FilmErrors> errors{};
  std::uint64_t replicas = 0;   // per pixel: complete ones, over which the errors are summed
  std::uint64_t rays = 0;       // traced for all of it
};

// Calls visit(name, may_be_absent, array...) for each array of a film, or of several films together, in the order of checkpoints. A film
// may be whatever has arrays of these names.
template <class Visit, class... Films>
void for_each_array(Visit visit, Films&... films) {
  visit("pixels", false, films.pixels...);
  visit("moments", true, films.moments...);
  visit("errors", false, films.errors...);
}

// Lets go of the memory behind pixels [first, end) of a film in files.
inline void release(const Film& film, std::size_t first, std::size_t end) {
  for_each_array([&](const char*, bool, const auto& array) { release(array, first, end); }, film);
}

// Without pixels; arrays that it is given will lie there.
Film empty_film(const FilmDirectory& directory);

// The film on the device, or a band of it.
struct FilmBuffers {
  cl::Buffer pixels, moments, errors;
};

// PoCL compiles a kernel again for launches of 65536 work items and more: never so many, and always whole groups.
inline constexpr std::size_t max_launch = 65472;

// Work items that a pass takes: the pixels of all tiles of the crop window.
std::size_t padded_pixels(const Settings& settings);

struct Renderer {
  const Device* device;
  Settings settings;
  FilmPlan plan;
  std::vector<cl::Buffer> scene;
  FilmBuffers film;
  cl::Buffer rays;
  cl::Kernel kernel;
  std::uint64_t first_sample = 0;  // number of the first sample that is rendered, a multiple of REPLICA_SAMPLES
  std::uint64_t samples = 0;       // per pixel, from there on, so far
  std::uint64_t restored_rays = 0; // of a film that was put back
  // Its arrays here. Of several bands the buffers hold one at a time, and these are the film; of one they are room for what is read.
  // Empty while they are lent, and before the first reading if they lie in memory and there is one band.
  Film on_host{};
};

KernelOptions kernel_options(const Scene& scene, const Bvh& bvh);

// Compiles and uploads. The device, the scene (without the input of the BVH) and the BVH must outlive the renderer.
// Throws Error(Exit::device), and Error(Exit::render_failed) if there is no room for a film in files.
Renderer start_render(const Device& device, const Scene& scene, const Bvh& bvh, const FilmPlan& film);
Renderer start_render(const Device& device, const Scene& scene, const Bvh& bvh, const FilmLimits& limits = {});
Renderer start_render(const Device& device, const Scene& scene, Bvh&& bvh, const FilmLimits& limits = {}) = delete;

// Adds `samples` samples to every pixel. `progress` is told, after each launch, the share of the pass that is done, in (0, 1].
// Throws Error(Exit::device).
void render_pass(Renderer& renderer, uint samples, const std::function<void(double)>& progress = {});

// Rays traced so far for the film. Throws Error(Exit::device).
std::uint64_t ray_count(const Renderer& renderer);

// A copy of the film.
Film read_film(const Renderer& renderer);

// Brings `film` up to the renderer without a copy of what is on the host already: the arrays there are lent. Those of a film in bands
// must be back before the next pass.
void take_film(Renderer& renderer, Film& film);
void return_film(Renderer& renderer, Film& film);

// Puts back a film that was read before, for rendering to go on behind its samples: one range of them, which begins at
// renderer.first_sample. Throws Error(Exit::render_failed) if the film is not one of this window, exponent and these moments, and
// Error(Exit::device).
void restore_film(Renderer& renderer, Film film);

}  // namespace oclair
