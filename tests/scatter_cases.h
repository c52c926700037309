// Materials and directions for the tests of the scattering models.
#pragma once

#include "inputs.h"
#include "kernel.h"

namespace oclair::test {

inline Material diffuse(float r, float g, float b) {
  Material material{};
  material.kind = MATERIAL_DIFFUSE;
  material.reflectance = {r, g, b};
  return material;
}

inline Material mirror(float r, float g, float b) {
  Material material = diffuse(r, g, b);
  material.kind = MATERIAL_MIRROR;
  return material;
}

// Gold-like by default: three different indices, so that swapped channels show.
inline Material conductor(packed_float3 eta = {0.143f, 0.375f, 1.442f}, packed_float3 k = {3.983f, 2.386f, 1.603f},
                          packed_float3 reflectance = {0.9f, 0.8f, 0.7f}) {
  Material material{};
  material.kind = MATERIAL_CONDUCTOR;
  material.reflectance = reflectance;
  material.conductor_eta = eta;
  material.conductor_k = k;
  return material;
}

inline Material dielectric(float eta, packed_float3 reflectance = {1, 1, 1}, packed_float3 transmittance = {1, 1, 1}) {
  Material material{};
  material.kind = MATERIAL_DIELECTRIC;
  material.reflectance = reflectance;
  material.transmittance = transmittance;
  material.eta = eta;
  return material;
}

inline Material thin_dielectric(float eta, packed_float3 reflectance = {1, 1, 1}, packed_float3 transmittance = {1, 1, 1}) {
  Material material = dielectric(eta, reflectance, transmittance);
  material.kind = MATERIAL_THIN_DIELECTRIC;
  return material;
}

// A diffuse kind that has a roughness.
inline Material rough(MaterialKind kind, float roughness, packed_float3 reflectance = {0.8f, 0.5f, 0.25f}) {
  Material material{};
  material.kind = kind;
  material.reflectance = reflectance;
  material.roughness = roughness;
  return material;
}

// Directions on the upper side, of unit length to float's rounding: along the axis, grazing down to a cosine of 1e-6, random.
inline std::vector<cl_float4> upper_directions(std::uint64_t seed, std::size_t count) {
  std::vector<cl_float4> list{{{0, 0, 1, 0}}};
  Random random(seed);
  const auto add = [&](double z) {
    const double phi = random.between(0, 6.28318530717958648), r = std::sqrt((1 - z) * (1 + z));
    list.push_back({{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(z), 0}});
  };
  for (int k = 1; k <= 6; ++k) add(std::pow(10.0, -k)), add(1 - std::pow(10.0, -k));
  while (list.size() < count) add(random.unit());
  return list;
}

// What a kernel writes of a Scatter.
struct Scatters {
  std::vector<cl_float4> direction_pdf, weight_eta;
  explicit Scatters(std::size_t count) : direction_pdf(count), weight_eta(count) {}
};

}  // namespace oclair::test
