#include "aov.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace oclair {
namespace {

// A layer in the making: its values as they are stored.
template <class Value>
struct Plane {
  bool wanted;
  const char* name;
  std::vector<std::string> channels;
  std::vector<Value> values;

  Plane(bool is_wanted, const char* layer, std::vector<std::string> names, std::size_t pixels)
      : wanted(is_wanted), name(layer), channels(std::move(names)), values(is_wanted ? pixels * channels.size() : 0) {}

  template <class... Values>
  void set(std::size_t pixel, Values... all) {
    if (!wanted) return;
    const Value row[] = {static_cast<Value>(all)...};
    std::copy(std::begin(row), std::end(row), values.begin() + static_cast<std::ptrdiff_t>(pixel * channels.size()));
  }

  void append_to(std::vector<Layer>& layers) {
    if (wanted) layers.push_back({name, channels, std::move(values)});
  }
};

struct Planes {
  Plane<float> albedo, normal, depth, uv;
  Plane<std::uint32_t> primitive;

  Planes(const Aovs& wanted, std::size_t pixels)
      : albedo(wanted.albedo, "albedo", {"R", "G", "B"}, pixels),
        normal(wanted.normal, "normal", {"X", "Y", "Z"}, pixels),
        depth(wanted.depth, "depth", {"Z"}, pixels),
        uv(wanted.uv, "uv", {"U", "V"}, pixels),
        primitive(wanted.primitive, "primitive", {"id"}, pixels) {}
};

// 0: none, then the triangles in the scene's order, then its quadrics.
std::uint32_t primitive_id(uint primitive, const Scene& scene) {
  if (primitive == NONE) return 0;
  const bool quadric = (primitive & QUADRIC_BIT) != 0;
  return 1 + (quadric ? static_cast<uint>(scene.triangle_shape.size()) + (primitive & ~QUADRIC_BIT) : primitive);
}

void store(const AovPixel& sum, const Scene& scene, Planes& planes) {
  constexpr double all = AOV_SAMPLES;
  const double hits = sum.hits;
  const auto mean = [](double value, double count) { return count > 0.0 ? value / count : 0.0; };
  planes.albedo.set(sum.pixel, sum.albedo.x / all, sum.albedo.y / all, sum.albedo.z / all);
  planes.normal.set(sum.pixel, sum.normal.x / all, sum.normal.y / all, sum.normal.z / all);
  planes.depth.set(sum.pixel, sum.hits > 0 ? std::ldexp(sum.depth / hits + scene.camera_depth, scene.frame.exponent)
                                           : std::numeric_limits<double>::infinity());
  planes.uv.set(sum.pixel, mean(sum.u, hits), mean(sum.v, hits));
  planes.primitive.set(sum.pixel, primitive_id(sum.primitive, scene));
}

KernelOptions aov_options(const Scene& scene, const Bvh& bvh, const Aovs& wanted) {
  KernelOptions options = kernel_options(scene, bvh);
  if (wanted.uv) options.features |= FEATURE_BITMAPS;  // without any texture a kernel works out no coordinates
  return options;
}

}  // namespace

std::vector<Layer> render_aovs(const Renderer& renderer, const Scene& scene, const Bvh& bvh, const Aovs& wanted) {
  const Device& device = *renderer.device;
  Planes planes(wanted, std::size_t{renderer.settings.crop_width} * renderer.settings.crop_height);
  try {
    cl::Kernel kernel(build_program(device, kernel_directory() / "aov.cl", aov_options(scene, bvh, wanted)), "aov");
    const std::size_t count = padded_pixels(renderer.settings);
    std::vector<AovPixel> pixels(std::min(max_launch, count));
    const cl::Buffer buffer(device.context, CL_MEM_READ_WRITE, pixels.size() * sizeof(AovPixel));
    const cl_uint next = bind_scene(kernel, renderer.scene);
    kernel.setArg(next, buffer);
    for (std::size_t base = 0; base < count; base += max_launch) {
      const std::size_t items = std::min(max_launch, count - base);
      kernel.setArg(next + 1, static_cast<cl_uint>(base));
      device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
      device.queue.enqueueReadBuffer(buffer, CL_TRUE, 0, items * sizeof(AovPixel), pixels.data());
      for (std::size_t i = 0; i < items; ++i)
        if (pixels[i].pixel != NONE) store(pixels[i], scene, planes);
    }
  } catch (const cl::Error& error) {
    throw device_error(device, error);
  }
  std::vector<Layer> layers;
  for (Plane<float>* plane : {&planes.albedo, &planes.normal, &planes.depth, &planes.uv}) plane->append_to(layers);
  planes.primitive.append_to(layers);
  return layers;
}

}  // namespace oclair
