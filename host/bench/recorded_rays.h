// The rays of a render: every one that the path tracer traces for some samples of every pixel, in the order of the stages
// (cl/stages.cl): all first segments of a sample, its first shadow rays, all second segments, ...
#pragma once

#include <cstdint>
#include <vector>

#include "../render.h"

namespace oclair::bench {

struct RecordedRays {
  std::vector<Ray> closest, any;
};

// Of samples [first, first + samples). The scene must not have FEATURE_OPACITY: its shadow rays pass through surfaces.
RecordedRays record_rays(const Device& device, const Scene& scene, const Bvh& bvh, std::uint64_t first, unsigned samples);

}  // namespace oclair::bench
