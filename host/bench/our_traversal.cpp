#include "our_traversal.h"

#include <algorithm>

#include "../render.h"
#include "timing.h"

namespace oclair::bench {
std::function<double()> timed_on(const Device& device, std::function<void()> run) {
  const bool cpu = (device.device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  return cpu ? timed_on_cpu(std::move(run)) : timed(std::move(run));
}

OurTraversal::OurTraversal(const Device& device, const Scene& scene, const Bvh& bvh) : device_(device) {
  const std::vector<BufferPlan> plan = plan_buffers(scene, bvh);
  check_memory(device, plan, {});
  scene_ = upload(device, plan);
  const cl::Program program =
      build_program(device, device.kernels / "traversal.cl", {scene.features, bvh.width, bvh.stack_size(), 0});
  closest_ = cl::Kernel(program, "closest_of_rays");
  any_ = cl::Kernel(program, "any_of_rays");
}

void OurTraversal::load(const std::vector<Ray>& rays) {
  count_ = rays.size();
  rays_ = cl::Buffer(device_.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, count_ * sizeof(Ray),
                     const_cast<Ray*>(rays.data()));
  hits_ = cl::Buffer(device_.context, CL_MEM_WRITE_ONLY, count_ * sizeof(Hit));
  blocked_ = cl::Buffer(device_.context, CL_MEM_WRITE_ONLY, count_ * sizeof(cl_uint));
}

void OurTraversal::run(bool any_hit) {
  cl::Kernel& kernel = any_hit ? any_ : closest_;
  const cl_uint next = bind_scene(kernel, scene_);
  kernel.setArg(next, rays_);
  kernel.setArg(next + 1, any_hit ? blocked_ : hits_);
  kernel.setArg(next + 3, static_cast<cl_uint>(count_));
  for (std::size_t base = 0; base < count_; base += max_launch) {
    const std::size_t groups = (std::min(max_launch, count_ - base) + WORK_GROUP_SIZE - 1) / WORK_GROUP_SIZE;
    kernel.setArg(next + 2, static_cast<cl_uint>(base));
    device_.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * WORK_GROUP_SIZE),
                                       cl::NDRange(WORK_GROUP_SIZE));
  }
  device_.queue.finish();
}

std::vector<Hit> OurTraversal::hits() const {
  std::vector<Hit> hits(count_);
  device_.queue.enqueueReadBuffer(hits_, CL_TRUE, 0, count_ * sizeof(Hit), hits.data());
  return hits;
}

std::vector<cl_uint> OurTraversal::blocked() const {
  std::vector<cl_uint> blocked(count_);
  device_.queue.enqueueReadBuffer(blocked_, CL_TRUE, 0, count_ * sizeof(cl_uint), blocked.data());
  return blocked;
}

}  // namespace oclair::bench
