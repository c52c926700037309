#include "upload.h"

#include <cassert>

namespace oclair {
namespace {

template <class Values>
BufferPlan plan_of(const char* name, const Values& values) {
  return {name, values.data(), values.size() * sizeof(values[0])};
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
