#include <set>

#include "groups.h"

namespace oclair::selftest {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014), Stafford's variant 13, as its authors print it.
ulong splitmix(ulong z) {
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

// Number n of the stream that begins at the state.
ulong nth(ulong state, ulong n) { return splitmix(state + n * 0x9e3779b97f4a7c15u); }

ulong independent_bits(ulong seed, uint pixel, ulong sample, uint dimension) {
  return nth(splitmix(nth(seed, 1) ^ (sample << 31 | pixel)), dimension + ulong{1});
}

float unit(ulong bits) { return static_cast<float>(bits >> 8 & 0xffffffu) * 0x1p-24f; }

struct Places {
  std::vector<cl_uint> pixel, dimension;
  std::vector<cl_ulong> sample;
};

struct Drawn {
  std::vector<cl_ulong> bits;
  std::vector<cl_float2> point;
};

Drawn draw(const Session& session, SamplerKind kind, ulong seed, const Places& places) {
  Settings settings{};
  settings.sampler = kind;
  settings.seed = seed;
  Drawn drawn{std::vector<cl_ulong>(places.pixel.size()), std::vector<cl_float2>(places.pixel.size())};
  run(session, "draw", places.pixel.size(), std::vector<Settings>{settings}, places.pixel, places.sample, places.dimension,
      out(drawn.bits), out(drawn.point));
  return drawn;
}

void check_units(const Session& session, Group& group) {
  std::vector<cl_uint> bits;
  for (uint i = 0; i < many; ++i) bits.push_back(i < 512 ? 0xffffffffu - i : i < 1024 ? i - 512 : i * 67117u);
  std::vector<float> result(bits.size());
  run(session, "units", bits.size(), bits, out(result));
  std::size_t outside = 0, wrong = 0;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    outside += !(result[i] >= 0.0f && result[i] < 1.0f);
    wrong += result[i] != unit(bits[i]);
  }
  group.bound("outside [0, 1)", static_cast<double>(outside), 0);
  group.bound("units wrong", static_cast<double>(wrong), 0);
}

void check_independent(const Session& session, Group& group) {
  Random random(6);
  Places places;
  for (std::size_t i = 0; i < many; ++i) {
    places.pixel.push_back(random.below(1u << 31));
    places.sample.push_back(random.engine() >> 31);
    places.dimension.push_back(random.below(16388));
  }
  const ulong seed = 7;
  const Drawn drawn = draw(session, SAMPLER_INDEPENDENT, seed, places);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < many; ++i) {
    const ulong exact = independent_bits(seed, places.pixel[i], places.sample[i], places.dimension[i]);
    wrong += drawn.bits[i] != exact || drawn.point[i].s[0] != unit(exact >> 32) ||
             drawn.point[i].s[1] != unit(exact & 0xffffffffu);
  }
  group.bound("independent numbers wrong", static_cast<double>(wrong), 0);
}

// Every elementary interval of area 1/16 holds one of the 16 points of a replica (Niederreiter 1992).
void check_nets(const Session& session, Group& group) {
  constexpr uint nets = 4000;
  Random random(7);
  Places places;
  for (uint i = 0; i < nets; ++i) {
    const uint pixel = random.below(1u << 31), dimension = i % 2;  // film and lens
    const ulong first = (random.engine() >> 31) & ~ulong{REPLICA_SAMPLES - 1};
    for (uint k = 0; k < REPLICA_SAMPLES; ++k) {
      places.pixel.push_back(pixel);
      places.sample.push_back(first + k);
      places.dimension.push_back(dimension);
    }
  }
  const Drawn drawn = draw(session, SAMPLER_SOBOL, 3, places);
  std::size_t broken = 0;
  for (std::size_t first = 0; first < drawn.point.size(); first += REPLICA_SAMPLES)
    for (int across = 0; across <= REPLICA_BITS; ++across) {
      std::set<std::pair<int, int>> cells;
      for (std::size_t i = first; i < first + REPLICA_SAMPLES; ++i)
        cells.emplace(static_cast<int>(std::ldexp(drawn.point[i].s[0], across)),
                      static_cast<int>(std::ldexp(drawn.point[i].s[1], REPLICA_BITS - across)));
      broken += cells.size() != REPLICA_SAMPLES;
    }
  group.measure("nets", nets);
  group.bound("partitions broken", static_cast<double>(broken), 0);
}

}  // namespace

void check_sampler(const Session& session, Group& group) {
  check_units(session, group);
  check_independent(session, group);
  check_nets(session, group);
}

}  // namespace oclair::selftest
