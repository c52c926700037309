#include "recorded_rays.h"

#include <algorithm>
#include <cassert>

#include "our_traversal.h"

namespace oclair::bench {
namespace {

struct Stages {
  const Device& device;
  cl::Program program;
  std::vector<cl::Buffer> scene;

  template <class... Arguments>
  void run(const char* name, std::size_t items, const Arguments&... arguments) {
    cl::Kernel kernel(program, name);
    cl_uint index = bind_scene(kernel, scene);
    (kernel.setArg(index++, arguments), ...);
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
  }
};

bool has_light(const ShadowRay& shadow) {
  return shadow.contribution.x > 0.0f || shadow.contribution.y > 0.0f || shadow.contribution.z > 0.0f;
}

}  // namespace

RecordedRays record_rays(const Device& device, const Scene& scene, const Bvh& bvh, std::uint64_t first, unsigned samples) {
  assert(!(scene.features & FEATURE_OPACITY));
  Stages stages{device, build_program(device, device.kernels / "stages.cl", kernel_options(scene, bvh)),
                upload(device, plan_buffers(scene, bvh))};
  const auto array = [&](std::size_t bytes) { return cl::Buffer(device.context, CL_MEM_READ_WRITE, max_launch * bytes); };
  const cl::Buffer paths = array(sizeof(PathState)), hits = array(sizeof(Hit)), shadows = array(sizeof(ShadowRay));
  std::vector<PathState> path_states(max_launch);
  std::vector<ShadowRay> shadow_states(max_launch);
  RecordedRays rays;
  const std::size_t count = padded_pixels(scene.settings);
  for (cl_ulong sample = first; sample < first + samples; ++sample) {
    for (std::size_t start = 0; start < count; start += max_launch) {
      const std::size_t items = std::min(max_launch, count - start);
      const cl_uint base = static_cast<cl_uint>(start);
      stages.run("camera_rays", items, paths, base, sample);
      for (;;) {
        device.queue.enqueueReadBuffer(paths, CL_TRUE, 0, items * sizeof(PathState), path_states.data());
        const std::size_t before = rays.closest.size();
        for (std::size_t i = 0; i < items; ++i)
          if (path_states[i].alive) rays.closest.push_back(path_states[i].ray);
        if (rays.closest.size() == before) break;
        stages.run("closest_hits", items, paths, hits);
        stages.run("shade", items, paths, hits, shadows, base, sample);
        device.queue.enqueueReadBuffer(shadows, CL_TRUE, 0, items * sizeof(ShadowRay), shadow_states.data());
        for (std::size_t i = 0; i < items; ++i)
          if (has_light(shadow_states[i])) rays.any.push_back(shadow_states[i].ray);
      }
    }
  }
  return rays;
}

}  // namespace oclair::bench
