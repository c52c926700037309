#include "render.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "error.h"
#include "variant.h"

namespace oclair {
namespace {

std::string description(uint width, uint height, int exponent, bool moments) {
  return std::to_string(width) + "x" + std::to_string(height) + " pixels " + (moments ? "with" : "without") + " moments in units of 2^" +
         std::to_string(exponent - FILM_FRACTION_BITS);
}

cl::Buffer zeroed(const Device& device, std::size_t bytes) {
  if (bytes == 0) return {};
  cl::Buffer buffer(device.context, CL_MEM_READ_WRITE, bytes);
  device.queue.enqueueFillBuffer(buffer, cl_ulong{0}, 0, bytes);
  return buffer;
}

// Blocks until it is done. The buffers hold the band.
void launch(Renderer& renderer, std::size_t band, std::size_t base, std::size_t items, uint samples) {
  const cl_uint first = static_cast<cl_uint>(renderer.scene.size()) + 4;
  renderer.kernel.setArg(first, static_cast<cl_ulong>(base));
  renderer.kernel.setArg(first + 1, static_cast<cl_uint>(band * renderer.plan.rows * renderer.settings.crop_width));
  renderer.kernel.setArg(first + 2, static_cast<cl_ulong>(renderer.first_sample + renderer.samples));
  renderer.kernel.setArg(first + 3, static_cast<cl_uint>(samples));
  const cl::CommandQueue& queue = renderer.device->queue;
  queue.enqueueNDRangeKernel(renderer.kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
  queue.finish();
}

std::size_t pixel_count(const Renderer& renderer) {
  return std::size_t{renderer.settings.crop_width} * renderer.settings.crop_height;
}

// An array like that one.
template <class T>
FilmVector<T> place_array(const FilmVector<T>&, std::size_t count, const FilmDirectory& directory) {
  return FilmVector<T>(count, FilmAllocator<T>(directory));
}

// The arrays of a film of this size, where the plan says; those that are there stay.
void allocate(const Renderer& renderer, Film& film) {
  const std::size_t count = pixel_count(renderer);
  for_each_array(
      [&](const char*, bool, const cl::Buffer& buffer, auto& array) {
        if (buffer() && array.size() != count) array = place_array(array, count, renderer.plan.directory);
      },
      renderer.film, film);
}

// Calls copy(buffer, offset, bytes, array) for pieces of each of the film's arrays, array being where the piece lies in it and offset, in
// bytes, where in the buffer, which holds the band.
template <class AnyFilm, class Copy>
void copy_band(const Renderer& renderer, std::size_t band, AnyFilm& film, Copy copy) {
  const std::size_t begin = band * renderer.plan.rows * renderer.settings.crop_width;
  const std::size_t count = std::min(pixel_count(renderer) - begin, std::size_t{renderer.plan.rows} * renderer.settings.crop_width);
  for_each_array(
      [&](const char*, bool, const cl::Buffer& buffer, auto& array) {
        constexpr std::size_t element = sizeof array[0];
        if (!buffer()) return;
        for_each_piece(count, [&](std::size_t first, std::size_t end) {
          copy(buffer, first * element, (end - first) * element, array.data() + begin + first);
          release(array, begin + first, begin + end);
        });
      },
      renderer.film, film);
}

void read_band(const Renderer& renderer, std::size_t band, Film& film) {
  copy_band(renderer, band, film, [&](const cl::Buffer& buffer, std::size_t offset, std::size_t bytes, void* array) {
    renderer.device->queue.enqueueReadBuffer(buffer, CL_TRUE, offset, bytes, array);
  });
}

void write_band(const Renderer& renderer, std::size_t band, const Film& film) {
  copy_band(renderer, band, film, [&](const cl::Buffer& buffer, std::size_t offset, std::size_t bytes, const void* array) {
    renderer.device->queue.enqueueWriteBuffer(buffer, CL_TRUE, offset, bytes, array);
  });
}

void read_whole(const Renderer& renderer, Film& film) {
  allocate(renderer, film);
  try {
    read_band(renderer, 0, film);
  } catch (const cl::Error& error) {
    throw device_error(*renderer.device, error);
  }
}

void swap_arrays(Film& a, Film& b) {
  for_each_array([](const char*, bool, auto& array, auto& other) { array.swap(other); }, a, b);
}

// All but the arrays.
void set_counts(const Renderer& renderer, Film& film) {
  film.width = renderer.settings.crop_width;
  film.height = renderer.settings.crop_height;
  film.exponent = renderer.settings.film_exponent;
  film.samples = renderer.samples;
  film.replicas = renderer.samples / REPLICA_SAMPLES;
  film.rays = ray_count(renderer);
}

}  // namespace

Film empty_film(const FilmDirectory& directory) {
  Film film;
  for_each_array([&](const char*, bool, auto& array) { array = place_array(array, 0, directory); }, film);
  return film;
}

std::size_t padded_pixels(const Settings& settings) {
  const std::size_t across = (settings.crop_width + TILE_WIDTH - 1) / TILE_WIDTH;
  const std::size_t down = (settings.crop_height + TILE_WIDTH - 1) / TILE_WIDTH;
  return across * down * WORK_GROUP_SIZE;
}

KernelOptions kernel_options(const Scene& scene, const Bvh& bvh) {
  const Features features =
      scene.exact_kernel ? scene.features : variant_features(variant_of(scene.features), scene.features);
  return {features, bvh.width, bvh.stack_size(), scene.approximations, scene.double_precision};
}

Renderer start_render(const Device& device, const Scene& scene, const Bvh& bvh, const FilmLimits& limits) {
  return start_render(device, scene, bvh, plan_film(device, scene, plan_buffers(scene, bvh), limits));
}

Renderer start_render(const Device& device, const Scene& scene, const Bvh& bvh, const FilmPlan& film) {
  const std::vector<BufferPlan> plan = plan_buffers(scene, bvh);
  check_memory(device, plan, film);
  try {
    Renderer renderer{&device, scene.settings, film, upload(device, plan),
                      {zeroed(device, film.film), zeroed(device, film.moments), zeroed(device, film.errors)},
                      zeroed(device, max_launch * sizeof(cl_ulong)), {}};
    if (film.bands > 1 || film.directory) allocate(renderer, renderer.on_host);  // in files: a full disk is told now
    renderer.kernel = cl::Kernel(build_program(device, device.kernels / "path.cl", kernel_options(scene, bvh)), "render");
    const cl_uint next = bind_scene(renderer.kernel, renderer.scene);
    renderer.kernel.setArg(next, renderer.film.pixels);
    renderer.kernel.setArg(next + 1, renderer.film.moments);
    renderer.kernel.setArg(next + 2, renderer.film.errors);
    renderer.kernel.setArg(next + 3, renderer.rays);
    launch(renderer, 0, 0, WORK_GROUP_SIZE, 0);  // PoCL compiles at the first launch: here, not in the first pass
    return renderer;
  } catch (const cl::Error& error) {
    throw device_error(device, error);
  }
}

void render_pass(Renderer& renderer, uint samples, const std::function<void(double)>& progress) {
  const std::size_t count = padded_pixels(renderer.settings);
  const std::size_t band_items = count / ((renderer.settings.crop_height + TILE_WIDTH - 1) / TILE_WIDTH) *
                                 ((renderer.plan.rows + TILE_WIDTH - 1) / TILE_WIDTH);
  const bool several = renderer.plan.bands > 1;
  assert(!several || !renderer.on_host.pixels.empty());
  try {
    for (std::size_t band = 0; band < renderer.plan.bands; ++band) {
      if (several) write_band(renderer, band, renderer.on_host);
      const std::size_t end = std::min(count, (band + 1) * band_items);
      for (std::size_t base = band * band_items; base < end; base += max_launch) {
        const std::size_t items = std::min(max_launch, end - base);
        launch(renderer, band, base, items, samples);
        if (progress) progress(static_cast<double>(base + items) / static_cast<double>(count));
      }
      if (several) read_band(renderer, band, renderer.on_host);
    }
  } catch (const cl::Error& error) {
    throw device_error(*renderer.device, error);
  }
  renderer.samples += samples;
}

std::uint64_t ray_count(const Renderer& renderer) {
  std::vector<std::uint64_t> rays(max_launch);
  try {
    renderer.device->queue.enqueueReadBuffer(renderer.rays, CL_TRUE, 0, max_launch * sizeof(cl_ulong), rays.data());
  } catch (const cl::Error& error) {
    throw device_error(*renderer.device, error);
  }
  return std::accumulate(rays.begin(), rays.end(), renderer.restored_rays);
}

Film read_film(const Renderer& renderer) {
  Film film = renderer.plan.bands > 1 ? renderer.on_host : Film();
  set_counts(renderer, film);
  if (renderer.plan.bands == 1) read_whole(renderer, film);
  return film;
}

void take_film(Renderer& renderer, Film& film) {
  set_counts(renderer, film);
  if (!renderer.on_host.pixels.empty()) swap_arrays(renderer.on_host, film);
  if (renderer.plan.bands == 1) read_whole(renderer, film);
}

void return_film(Renderer& renderer, Film& film) {
  if (renderer.on_host.pixels.empty()) swap_arrays(renderer.on_host, film);
}

void restore_film(Renderer& renderer, Film film) {
  const Settings& settings = renderer.settings;
  const std::size_t count = pixel_count(renderer);
  const bool moments = renderer.film.moments() != nullptr;
  if (film.width != settings.crop_width || film.height != settings.crop_height || film.exponent != settings.film_exponent ||
      film.pixels.size() != count || film.moments.size() != (moments ? count : 0))
    throw Error(Exit::render_failed, "film: " + description(film.width, film.height, film.exponent, !film.moments.empty()) +
                                         ", expected " +
                                         description(settings.crop_width, settings.crop_height, settings.film_exponent, moments));
  if (film.errors.size() != count || film.replicas != film.samples / REPLICA_SAMPLES)
    throw Error(Exit::render_failed, "film: its errors are not those of one range of samples, expected " +
                                         std::to_string(film.samples / REPLICA_SAMPLES) + " replicas");
  try {
    renderer.device->queue.enqueueFillBuffer(renderer.rays, cl_ulong{0}, 0, max_launch * sizeof(cl_ulong));
    if (renderer.plan.bands == 1) write_band(renderer, 0, film);
    swap_arrays(renderer.on_host, film);
  } catch (const cl::Error& error) {
    throw device_error(*renderer.device, error);
  }
  renderer.samples = film.samples;
  renderer.restored_rays = film.rays;
}

}  // namespace oclair
