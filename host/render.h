// Renders a scene: compiles its kernel, runs passes, keeps the film on the device.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "upload.h"

namespace oclair {

// The film as the device leaves it, row by row over the crop window.
struct Film {
  uint width = 0, height = 0;
  int exponent = 0;             // Settings::film_exponent
  std::uint64_t samples = 0;    // per pixel, rejected ones included
  std::vector<FilmPixel> pixels;
  std::vector<FilmMoments> moments;  // empty without FEATURE_MOMENTS
  std::vector<FilmErrors> errors{};
  std::uint64_t replicas = 0;   // per pixel: complete ones, over which the errors are summed
  std::uint64_t rays = 0;       // traced for all of it
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
  cl::Buffer film, moments, errors, rays;
  cl::Kernel kernel;
  std::uint64_t first_sample = 0;  // number of the first sample that is rendered, a multiple of REPLICA_SAMPLES
  std::uint64_t samples = 0;       // per pixel, from there on, so far
  std::uint64_t restored_rays = 0; // of a film that was put back
  Film on_host{};                  // its arrays, if there are several bands: the buffers hold one at a time
};

KernelOptions kernel_options(const Scene& scene, const Bvh& bvh);

// Compiles and uploads. The device, the scene (without the input of the BVH) and the BVH must outlive the renderer.
// `most_film`: bytes of film on the device, see plan_film. Throws Error(Exit::device).
Renderer start_render(const Device& device, const Scene& scene, const Bvh& bvh,
                      std::size_t most_film = std::numeric_limits<std::size_t>::max());
Renderer start_render(const Device& device, const Scene& scene, Bvh&& bvh, std::size_t most_film = 0) = delete;

// Adds `samples` samples to every pixel. `progress` is told, after each launch, the share of the pass that is done, in (0, 1].
// Throws Error(Exit::device).
void render_pass(Renderer& renderer, uint samples, const std::function<void(double)>& progress = {});

// Rays traced so far for the film. Throws Error(Exit::device).
std::uint64_t ray_count(const Renderer& renderer);

Film read_film(const Renderer& renderer);

// Puts back a film that was read before, for rendering to go on behind its samples: one range of them, which begins at
// renderer.first_sample. Throws Error(Exit::render_failed) if the film is not one of this window, exponent and these moments, and
// Error(Exit::device).
void restore_film(Renderer& renderer, const Film& film);

}  // namespace oclair
