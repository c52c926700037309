// The scattering models through the switch over them: the kernels of bsdf_test.cl.
#pragma once

#include "scatter_cases.h"

namespace oclair::test {

struct Model {
  const char* name;
  Material material;
  Features feature;
  bool is_delta;
};

inline const std::vector<Model>& models() {
  static const std::vector<Model> list{{"diffuse", diffuse(0.8f, 0.5f, 0.25f), FEATURE_DIFFUSE, false},
                                       {"mirror", mirror(0.9f, 0.5f, 0.1f), FEATURE_MIRROR, true},
                                       {"conductor", conductor(), FEATURE_CONDUCTOR, true},
                                       {"dielectric", dielectric(1.5f, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f}),
                                        FEATURE_DIELECTRIC, true},
                                       {"oren_nayar", rough(MATERIAL_OREN_NAYAR, 0.5f), FEATURE_OREN_NAYAR, false},
                                       {"oren_nayar_fast", rough(MATERIAL_OREN_NAYAR_FAST, 0.5f), FEATURE_OREN_NAYAR_FAST, false},
                                       {"disney", rough(MATERIAL_DISNEY, 0.75f), FEATURE_DISNEY, false},
                                       {"thin dielectric", thin_dielectric(1.5f, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f}),
                                        FEATURE_THIN_DIELECTRIC, true}};
  return list;
}

struct Inputs {
  std::vector<cl_float4> wo;
  std::vector<cl_uint> front;
  std::vector<cl_float2> u;
};

inline Inputs random_inputs(std::uint64_t seed, std::size_t count) {
  Inputs inputs{upper_directions(seed, count), {}, {}};
  Random random(seed + 1);
  for (std::size_t i = 0; i < inputs.wo.size(); ++i) {
    inputs.front.push_back(static_cast<cl_uint>(random.engine() >> 63));
    const float x = static_cast<float>(random.engine() >> 40) * 0x1p-24f, y = static_cast<float>(random.engine() >> 40) * 0x1p-24f;
    inputs.u.push_back({{x, y}});
  }
  return inputs;
}

inline Scatters sample_bsdf(const Material& material, const Inputs& inputs, Features features = every_feature,
                            Approximations approximations = 0) {
  const std::size_t count = inputs.wo.size();
  Scatters result(count);
  run_with({features, 8, 64, approximations}, "bsdf_test.cl", "sample", count, std::vector(count, material), inputs.wo, inputs.front, inputs.u,
           out(result.direction_pdf), out(result.weight_eta));
  return result;
}

struct Values {
  std::vector<cl_float4> value_pdf;
  std::vector<cl_uint> is_delta;
};

// wo: one direction for all, or one for each wi.
inline Values evaluate_bsdf(const Material& material, const std::vector<cl_float4>& wi, Features features = every_feature,
                            std::vector<cl_float4> wo = {{{0.6f, 0, 0.8f, 0}}}) {
  if (wo.size() == 1) wo.assign(wi.size(), wo[0]);
  Values result{std::vector<cl_float4>(wi.size()), std::vector<cl_uint>(wi.size())};
  run_with({features}, "bsdf_test.cl", "evaluate", wi.size(), std::vector(wi.size(), material), wo, wi,
           out(result.value_pdf), out(result.is_delta));
  return result;
}

}  // namespace oclair::test
