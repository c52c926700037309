// The traversals of cl/traverse.h over rays in a buffer.
#pragma once

#include <functional>
#include <vector>

#include "../bvh.h"
#include "../device.h"
#include "../scene.h"

namespace oclair::bench {

// In one thread: processor time of what the device does, if it is a CPU, or else wall time.
std::function<double()> timed_on(const Device& device, std::function<void()> run);

class OurTraversal {
 public:
  // Compiles and uploads. The device, the scene and the BVH must outlive it. Throws Error(Exit::device).
  OurTraversal(const Device& device, const Scene& scene, const Bvh& bvh);
  OurTraversal(const Device& device, const Scene& scene, Bvh&& bvh) = delete;

  void load(const std::vector<Ray>& rays);
  void run(bool any_hit);                // over all rays; returns when it is done
  std::vector<Hit> hits() const;         // after run(false)
  std::vector<cl_uint> blocked() const;  // after run(true)

 private:
  const Device& device_;
  std::vector<cl::Buffer> scene_;
  cl::Kernel closest_, any_;
  cl::Buffer rays_, hits_, blocked_;
  std::size_t count_ = 0;
};

}  // namespace oclair::bench
