// Which samples a film holds. Every pixel has the same ones: a sample is a number that all pixels share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../cl/types.h"

namespace oclair {

// Numbers of samples end here: that is what rng_key and the film's sums can take.
inline constexpr std::uint64_t MAX_SAMPLES = std::uint64_t{1} << 33;

// Samples first, first + 1, ..., first + count - 1.
struct SampleRange {
  std::uint64_t first = 0, count = 0;

  std::uint64_t end() const { return first + count; }
  bool operator==(const SampleRange&) const = default;
};

// FIRST:COUNT, as --samples takes it.
inline std::string to_string(const SampleRange& range) {
  return std::to_string(range.first) + ":" + std::to_string(range.count);
}

// Disjoint ranges in ascending order, as few as there can be.
std::vector<SampleRange> joined(std::vector<SampleRange> disjoint);

std::uint64_t count_samples(const std::vector<SampleRange>& disjoint);

// Complete replicas (FilmErrors) of ranges that begin with one each: what a range holds of its last one, if it ends within,
// counts in the mean of a pixel, but not in its error.
std::uint64_t count_replicas(const std::vector<SampleRange>& disjoint);

}  // namespace oclair
