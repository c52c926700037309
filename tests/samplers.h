// Numbers of a sampler from the device.
#pragma once

#include "kernel.h"

namespace oclair::test {

struct SamplerPlace {
  cl_uint pixel;
  cl_ulong sample;
  cl_uint dimension;
};

struct SamplerBits {
  std::vector<cl_ulong> bits, independent;  // the latter: what the independent sampler says
};

inline SamplerBits draw_bits(SamplerKind kind, cl_ulong seed, const std::vector<SamplerPlace>& places,
                             Features features = every_feature) {
  Settings settings{};
  settings.sampler = kind;
  settings.seed = seed;
  std::vector<cl_uint> pixel, dimension;
  std::vector<cl_ulong> sample;
  for (const SamplerPlace& p : places) pixel.push_back(p.pixel), sample.push_back(p.sample), dimension.push_back(p.dimension);
  SamplerBits result{std::vector<cl_ulong>(places.size()), std::vector<cl_ulong>(places.size())};
  run_with({features}, "sampler_test.cl", "draw", places.size(), std::vector<Settings>{settings}, pixel, sample, dimension,
           out(result.bits), out(result.independent));
  return result;
}

// Below it the Sobol sampler has nets.
inline cl_uint sobol_dimensions() {
  std::vector<cl_uint> dimensions(1);
  run("sampler_test.cl", "dimensions", 1, out(dimensions));
  return dimensions[0];
}

// The digits that a net decides, of the first coordinate (0) or the second one (1).
inline cl_uint net_digits(cl_ulong bits, int coordinate) {
  return static_cast<cl_uint>(bits >> (coordinate == 0 ? 32 : 0)) >> (32 - REPLICA_BITS);
}

}  // namespace oclair::test
