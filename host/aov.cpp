#include "aov.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <utility>

namespace oclair {
namespace {

// Layers of the wanted AOVs, one for each channel, or none.
class Channels {
 public:
  Channels(bool wanted, const std::string& name, const std::vector<std::string>& channels, std::size_t pixels) {
    if (!wanted) return;
    for (const std::string& channel : channels) layers_.push_back({name + "." + channel, std::vector<float>(pixels)});
  }

  void set(std::size_t pixel, std::initializer_list<double> values) {
    for (std::size_t c = 0; c < layers_.size(); ++c) layers_[c].values[pixel] = static_cast<float>(values.begin()[c]);
  }
  void set_integer(std::size_t pixel, std::uint32_t value) {
    for (Layer& layer : layers_) layer.values[pixel] = std::bit_cast<float>(value);
  }

  void append_to(std::vector<Layer>& layers) { std::move(layers_.begin(), layers_.end(), std::back_inserter(layers)); }

 private:
  std::vector<Layer> layers_;
};

struct AllChannels {
  Channels albedo, normal, depth, uv, primitive;

  AllChannels(const Aovs& wanted, std::size_t pixels)
      : albedo(wanted.albedo, "albedo", {"R", "G", "B"}, pixels),
        normal(wanted.normal, "normal", {"X", "Y", "Z"}, pixels),
        depth(wanted.depth, "depth", {"Z"}, pixels),
        uv(wanted.uv, "uv", {"U", "V"}, pixels),
        primitive(wanted.primitive, "primitive", {"id"}, pixels) {}

  std::vector<Layer> layers() && {
    std::vector<Layer> all;
    for (Channels* aov : {&albedo, &normal, &depth, &uv, &primitive}) aov->append_to(all);
    return all;
  }
};

// 0: none, then the triangles in the scene's order, then its quadrics.
std::uint32_t primitive_id(uint primitive, const Scene& scene) {
  if (primitive == NONE) return 0;
  const bool quadric = (primitive & QUADRIC_BIT) != 0;
  return 1 + (quadric ? static_cast<uint>(scene.triangle_shape.size()) + (primitive & ~QUADRIC_BIT) : primitive);
}

void store(const AovPixel& sum, const Scene& scene, AllChannels& channels) {
  constexpr double all = AOV_SAMPLES;
  const double hits = std::max(sum.hits, 1u);  // of none all sums are 0
  const double depth = sum.hits > 0 ? std::ldexp(sum.depth / hits + scene.camera_depth, scene.frame.exponent)
                                    : std::numeric_limits<double>::infinity();
  channels.albedo.set(sum.pixel, {sum.albedo.x / all, sum.albedo.y / all, sum.albedo.z / all});
  channels.normal.set(sum.pixel, {sum.normal.x / all, sum.normal.y / all, sum.normal.z / all});
  channels.depth.set(sum.pixel, {depth});
  channels.uv.set(sum.pixel, {sum.u / hits, sum.v / hits});
  channels.primitive.set_integer(sum.pixel, primitive_id(sum.primitive, scene));
}

KernelOptions aov_options(const Scene& scene, const Bvh& bvh, const Aovs& wanted) {
  KernelOptions options = kernel_options(scene, bvh);
  options.double_precision = false;  // the layers are sums of floats
  if (wanted.uv) options.features |= FEATURE_BITMAPS;  // without any texture a kernel works out no coordinates
  return options;
}

}  // namespace

std::size_t aov_order(std::string_view layer) {
  constexpr std::string_view order[] = {"albedo", "normal", "depth", "uv", "primitive"};
  const std::string_view aov = layer.substr(0, layer.find('.'));
  return static_cast<std::size_t>(std::find(std::begin(order), std::end(order), aov) - std::begin(order));
}

std::size_t channel_count(const Aovs& wanted) { return AllChannels(wanted, 0).layers().size(); }

std::vector<Layer> render_aovs(const Renderer& renderer, const Scene& scene, const Bvh& bvh, const Aovs& wanted) {
  const Device& device = *renderer.device;
  AllChannels channels(wanted, std::size_t{renderer.settings.crop_width} * renderer.settings.crop_height);
  try {
    cl::Kernel kernel(build_program(device, device.kernels / "aov.cl", aov_options(scene, bvh, wanted)), "aov");
    const std::size_t count = padded_pixels(renderer.settings);
    std::vector<AovPixel> pixels(std::min(max_launch, count));
    const cl::Buffer buffer(device.context, CL_MEM_READ_WRITE, pixels.size() * sizeof(AovPixel));
    const cl_uint next = bind_scene(kernel, renderer.scene);
    kernel.setArg(next, buffer);
    for (std::size_t base = 0; base < count; base += max_launch) {
      const std::size_t items = std::min(max_launch, count - base);
      kernel.setArg(next + 1, static_cast<cl_ulong>(base));
      device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
      device.queue.enqueueReadBuffer(buffer, CL_TRUE, 0, items * sizeof(AovPixel), pixels.data());
      for (std::size_t i = 0; i < items; ++i)
        if (pixels[i].pixel != NONE) store(pixels[i], scene, channels);
    }
  } catch (const cl::Error& error) {
    throw device_error(device, error);
  }
  return std::move(channels).layers();
}

}  // namespace oclair
