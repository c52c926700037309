#include "upload.h"

#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "error.h"

namespace oclair {
namespace {

template <class Values>
BufferPlan plan_of(const char* name, const Values& values) {
  return {name, values.data(), values.size() * sizeof(values[0])};
}

std::size_t bytes_of(const std::vector<BufferPlan>& plan) {
  return std::accumulate(plan.begin(), plan.end(), std::size_t{0},
                         [](std::size_t sum, const BufferPlan& b) { return sum + b.bytes; });
}

std::size_t host_memory() {
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::vector<BufferPlan> plan_buffers(const Scene& scene, const Bvh& bvh) {
  return {plan_of("nodes", bvh.nodes),
          plan_of("triangle blocks", bvh.blocks),
          plan_of("quadrics", scene.quadrics),
          plan_of("shapes", scene.shapes),
          plan_of("triangle shapes", scene.triangle_shape),
          plan_of("triangle vertices", scene.triangle_vertices),
          plan_of("normals", scene.normals),
          plan_of("texture coordinates", scene.uvs),
          plan_of("materials", scene.materials),
          plan_of("textures", scene.textures),
          plan_of("texels", scene.texels),
          plan_of("sRGB table", scene.srgb),
          plan_of("lights", scene.lights),
          plan_of("light distribution", scene.light_cdf),
          plan_of("environment distribution", scene.environment_cdf),
          plan_of("filter", scene.filter),
          {"camera", &scene.camera, sizeof(Camera)},
          {"settings", &scene.settings, sizeof(Settings)}};
}

double bytes_per_triangle(const Scene& scene, const Bvh& bvh) {
  assert(!scene.triangles.empty());
  std::size_t bytes = 0;
  for (const BufferPlan& buffer :
       {plan_of("", bvh.nodes), plan_of("", bvh.blocks), plan_of("", scene.triangle_shape), plan_of("", scene.triangle_vertices),
        plan_of("", scene.normals), plan_of("", scene.uvs)})
    bytes += buffer.bytes;
  return static_cast<double>(bytes) / static_cast<double>(scene.triangles.size());
}

FilmPlan plan_film(const Device& device, const Scene& scene, const std::vector<BufferPlan>& plan, std::size_t most) {
  const std::size_t width = scene.settings.crop_width, height = scene.settings.crop_height;
  const std::size_t moments = scene.features & FEATURE_MOMENTS ? sizeof(FilmMoments) : 0;
  const std::size_t scene_bytes = bytes_of(plan), all = device.device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const std::size_t taken = scene_bytes + all / 16;  // and what else there is: rays, layers, the driver's own
  const std::size_t room = std::min(most, all - std::min(all, taken));
  const std::size_t largest = device.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  std::size_t rows = std::min(room / (width * (sizeof(FilmPixel) + moments + sizeof(FilmErrors))),
                              largest / (width * std::max({sizeof(FilmPixel), moments, sizeof(FilmErrors)})));
  rows = rows >= height ? height : std::max<std::size_t>(TILE_WIDTH, rows - rows % TILE_WIDTH);
  const std::size_t pixels = width * rows;
  return {static_cast<uint>(rows), static_cast<uint>((height + rows - 1) / rows), pixels * sizeof(FilmPixel), pixels * moments,
          pixels * sizeof(FilmErrors)};
}

void check_memory(const Device& device, const std::vector<BufferPlan>& plan, const FilmPlan& film) {
  const std::size_t largest_allowed = device.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  const std::size_t all_allowed = device.device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const auto mib = [](std::size_t bytes) { return std::to_string((bytes + 0xfffff) >> 20) + " MiB"; };
  const auto check = [&](const std::string& name, std::size_t bytes, std::size_t allowed) {
    if (bytes > allowed)
      throw Error(Exit::device, "device memory: " + name + " takes " + mib(bytes) + ", expected at most " + mib(allowed) + " on " +
                                    device.name);
  };
  for (const BufferPlan& buffer : plan) check("buffer \"" + buffer.name + "\"", buffer.bytes, largest_allowed);
  check("buffer \"film\"", film.film, largest_allowed);
  check("buffer \"moments\"", film.moments, largest_allowed);
  check("buffer \"errors\"", film.errors, largest_allowed);
  const std::size_t band = film.film + film.moments + film.errors;
  check("the scene with its film", bytes_of(plan) + band, all_allowed);
  const std::size_t whole = band * film.bands;
  if (film.bands > 1 && 2 * whole > host_memory())
    throw Error(Exit::device, "memory: the film and the copy that is written take " + mib(2 * whole) + ", expected at most the " +
                                  mib(host_memory()) + " that there are; render it in parts, with crop windows or a smaller --size");
}

std::vector<cl::Buffer> upload(const Device& device, const std::vector<BufferPlan>& plan) {
  const bool shared = device.device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>();
  const cl_mem_flags flags = CL_MEM_READ_ONLY | (shared ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR);
  std::vector<cl::Buffer> buffers;
  for (const BufferPlan& buffer : plan)
    buffers.push_back(buffer.bytes == 0 ? cl::Buffer()
                                        : cl::Buffer(device.context, flags, buffer.bytes, const_cast<void*>(buffer.data)));
  return buffers;
}

cl_uint bind_scene(cl::Kernel& kernel, const std::vector<cl::Buffer>& buffers) {
  cl_uint index = 0;
  for (const cl::Buffer& buffer : buffers) kernel.setArg(index++, buffer);
  return index;
}

}  // namespace oclair
