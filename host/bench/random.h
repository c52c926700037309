// Numbers that depend on nothing but their index.
#pragma once

#include <cstdint>

namespace oclair::bench {

// In [0, 1), 53 bits: the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
inline double random_unit(std::uint64_t index, std::uint64_t dimension) {
  std::uint64_t x = (index + 1) * 0x9e3779b97f4a7c15u + dimension * 0xd1b54a32d192ed03u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

}  // namespace oclair::bench
