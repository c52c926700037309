#include "film_plan.h"

#include <unistd.h>

#include <algorithm>
#include <numeric>

#include "error.h"

namespace oclair {
namespace {

std::size_t bytes_of(const std::vector<BufferPlan>& plan) {
  return std::accumulate(plan.begin(), plan.end(), std::size_t{0},
                         [](std::size_t sum, const BufferPlan& b) { return sum + b.bytes; });
}

std::size_t host_memory() {
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

bool shares_memory(const Device& device) { return device.device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>(); }

}  // namespace

std::string mib(std::size_t bytes) { return std::to_string((bytes + 0xfffff) >> 20) + " MiB"; }

std::size_t default_film_memory() { return host_memory() / 2; }

FilmPlan plan_film(const Device& device, const Scene& scene, const std::vector<BufferPlan>& plan, const FilmLimits& limits) {
  const std::size_t width = scene.settings.crop_width, height = scene.settings.crop_height;
  const std::size_t moments = scene.features & FEATURE_MOMENTS ? sizeof(FilmMoments) : 0;
  const std::size_t pixel = sizeof(FilmPixel) + moments + sizeof(FilmErrors), film = width * height * pixel;
  const std::size_t whole = film + width * height * limits.error_bytes;
  const bool shared = shares_memory(device);
  const bool in_file = whole + (shared ? std::min(film, limits.in_memory / 4) : 0) > limits.in_memory;

  const std::size_t scene_bytes = bytes_of(plan), all = device.device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const std::size_t taken = scene_bytes + all / 16;  // and what else there is: rays, layers, the driver's own
  std::size_t room = std::min(limits.on_device, all - std::min(all, taken));
  if (shared && whole + film > limits.in_memory) room = std::min(room, limits.in_memory / 4);
  const std::size_t largest = device.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  std::size_t rows = std::min(room / (width * pixel), largest / (width * std::max({sizeof(FilmPixel), moments, sizeof(FilmErrors)})));
  rows = rows >= height ? height : std::max<std::size_t>(TILE_WIDTH, rows - rows % TILE_WIDTH);
  const std::size_t pixels = width * rows;
  return {static_cast<uint>(rows), static_cast<uint>((height + rows - 1) / rows), pixels * sizeof(FilmPixel), pixels * moments,
          pixels * sizeof(FilmErrors), whole, width * height * limits.layer_bytes,
          in_file ? std::make_shared<const std::filesystem::path>(limits.directory) : nullptr};
}

void check_memory(const Device& device, const std::vector<BufferPlan>& plan, const FilmPlan& film) {
  const std::size_t largest_allowed = device.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  const std::size_t all_allowed = device.device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const auto check = [&](const std::string& name, std::size_t bytes, std::size_t allowed) {
    if (bytes > allowed)
      throw Error(Exit::device, "device memory: " + name + " takes " + mib(bytes) + ", expected at most " + mib(allowed) + " on " +
                                    device.name);
  };
  for (const BufferPlan& buffer : plan) check("buffer \"" + buffer.name + "\"", buffer.bytes, largest_allowed);
  check("buffer \"film\"", film.film, largest_allowed);
  check("buffer \"moments\"", film.moments, largest_allowed);
  check("buffer \"errors\"", film.errors, largest_allowed);
  const std::size_t on_device = bytes_of(plan) + film.band();
  check("the scene with its film", on_device, all_allowed);
  const std::size_t on_host = (film.directory ? 0 : film.whole) + film.layers + (shares_memory(device) ? on_device : 0);
  if (on_host > host_memory())
    throw Error(Exit::device, "memory: the scene, the film and its layers take " + mib(on_host) + ", expected at most the " +
                                  mib(host_memory()) + " that there are; a smaller --host-memory puts the film into a file, a crop window or --size makes it smaller");
}

}  // namespace oclair
