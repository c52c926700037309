// The traversals of cl/traverse.h over rays in a buffer.
#pragma once

#include <vector>

#include "../bvh.h"
#include "../device.h"
#include "../scene.h"

namespace oclair::bench {

class OurTraversal {
 public:
  // Compiles and uploads. The device must outlive it. Throws Error(Exit::device).
  OurTraversal(const Device& device, const Scene& scene, const Bvh& bvh);

  bool on_cpu() const;  // its work is processor time of this process

  void load(const std::vector<Ray>& rays);
  void run(bool any_hit);  // over all rays; returns when it is done
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
