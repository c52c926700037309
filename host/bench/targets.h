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

// Ratios to Embree are its time over ours, in one thread.
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
};

std::optional<Target> target_of(const std::string& name);
bool met(const Target& target, double figure);

}  // namespace oclair::bench
