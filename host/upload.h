// The scene on the device: which buffers, how large, and the arguments of the kernels that read them.
#pragma once

#include <cstddef>
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

// A device that shares the host's memory reads the plan's arrays where they lie: these must outlive the buffers.
std::vector<cl::Buffer> upload(const Device& device, const std::vector<BufferPlan>& plan);

// Sets the kernel's first arguments to the buffers; returns the index of the next argument.
cl_uint bind_scene(cl::Kernel& kernel, const std::vector<cl::Buffer>& buffers);

}  // namespace oclair
