// What the figures are to reach: each once, by name.
#pragma once

#include <optional>
#include <string>

namespace oclair::bench {

struct Target {
  const char* name;  // of the row
  bool at_least;     // otherwise: at most
  double value;
};

// Ratios to Embree are its time over ours.
inline constexpr Target targets[] = {
    {"70k diffuse closest: rtcIntersect1", true, 1.10},
    {"70k diffuse closest: rtcIntersect1 robust", true, 1.30},
    {"70k primary closest: rtcIntersect1", true, 1.25},
    {"70k shadow any: rtcOccluded1", true, 1.15},
    {"70k shadow any: rtcOccluded1 robust", true, 1.30},
    {"70k ao any: rtcOccluded1", true, 1.15},
    {"70k ao any: rtcOccluded1 robust", true, 1.30},
    {"1.3M diffuse closest: rtcIntersect1", true, 1.00},
    {"1.3M diffuse closest: rtcIntersect1 robust", true, 1.30},
    {"1.3M primary closest: rtcIntersect1", true, 1.25},
    {"1.3M shadow any: rtcOccluded1", true, 1.05},
    {"1.3M shadow any: rtcOccluded1 robust", true, 1.30},
    {"1.3M ao any: rtcOccluded1", true, 1.05},
    {"1.3M ao any: rtcOccluded1 robust", true, 1.30},
    {"70k rays/s, share of the bare traversal", true, 0.85},
    {"1.3M rays/s, share of the bare traversal", true, 0.85},
    {"70k samples/s, 2 cores against one", true, 1.95},
    {"1.3M samples/s, 2 cores against one", true, 1.95},
    {"70k build, one core: rtcCommitScene", true, 1.00},
    {"70k build, all cores: rtcCommitScene", true, 1.00},
    {"1.3M build, one core: rtcCommitScene", true, 1.00},
    {"1.3M build, all cores: rtcCommitScene", true, 1.00},
    {"1.3M device memory per triangle", false, 96.0},
    {"1.3M smooth device memory per triangle", false, 96.0},
    {"10M at 1024x1024, process memory", false, 4.0},
    {"start, kernels compiled before", false, 0.15},
    {"start, first time, kernel with all features", false, 2.5},
};

std::optional<Target> target_of(const std::string& name);
bool met(const Target& target, double figure);

}  // namespace oclair::bench
