#include "sample_range.h"

#include <algorithm>
#include <cassert>

namespace oclair {

std::vector<SampleRange> joined(std::vector<SampleRange> disjoint) {
  std::sort(disjoint.begin(), disjoint.end(), [](const SampleRange& a, const SampleRange& b) { return a.first < b.first; });
  std::vector<SampleRange> result;
  for (const SampleRange& range : disjoint) {
    assert(result.empty() || result.back().end() <= range.first);
    if (!result.empty() && result.back().end() == range.first) result.back().count += range.count;
    else result.push_back(range);
  }
  return result;
}

std::uint64_t count_samples(const std::vector<SampleRange>& disjoint) {
  std::uint64_t sum = 0;
  for (const SampleRange& range : disjoint) sum += range.count;
  return sum;
}

std::uint64_t count_replicas(const std::vector<SampleRange>& disjoint) {
  std::uint64_t sum = 0;
  for (const SampleRange& range : disjoint) sum += range.count / REPLICA_SAMPLES;
  return sum;
}

}  // namespace oclair
