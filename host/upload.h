// The scene on the device: which buffers, how large, and the arguments of the kernels that read them.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "bvh.h"
#include "device.h"
#include "scene.h"

namespace oclair {

// One buffer of the scene. Without bytes it is not made, and the kernel gets NULL.
struct BufferPlan {
  std::string name;
  const void* data;
  std::size_t bytes;
};

// In the order of SCENE_ARGUMENTS (cl/scene.h). Points into scene and bvh.
std::vector<BufferPlan> plan_buffers(const Scene& scene, const Bvh& bvh);

// What a triangle costs on the device, bytes: its share of the tree, of the leaves and of what shading asks for. Lights and textures
// are the scene's. The scene has triangles.
double bytes_per_triangle(const Scene& scene, const Bvh& bvh);

// The film's buffers, which the device fills: pixels, second moments if the scene asks for them, and what the error is made of. A film
// that is too large for the device lies there a band of rows at a time, and as a whole on the host.
struct FilmPlan {
  uint rows = 0;   // of a band: a multiple of TILE_WIDTH, or all; the last band may have fewer
  uint bands = 0;
  std::size_t film = 0, moments = 0, errors = 0;  // bytes for one band
};

// As few bands as the device's memory allows beside the scene, and `most` bytes of film on it; a band has a row of tiles at least.
FilmPlan plan_film(const Device& device, const Scene& scene, const std::vector<BufferPlan>& plan,
                   std::size_t most = std::numeric_limits<std::size_t>::max());

// Throws Error(Exit::device) if a buffer exceeds what the device allocates at once, or all of them its memory, or if a film in bands
// exceeds the host's.
void check_memory(const Device& device, const std::vector<BufferPlan>& plan, const FilmPlan& film);

// A device that shares the host's memory reads the plan's arrays where they lie: these must outlive the buffers.
std::vector<cl::Buffer> upload(const Device& device, const std::vector<BufferPlan>& plan);

// Sets the kernel's first arguments to the buffers; returns the index of the next argument.
cl_uint bind_scene(cl::Kernel& kernel, const std::vector<cl::Buffer>& buffers);

}  // namespace oclair
