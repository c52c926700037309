#include <cmath>
#include <cstdio>

#include "../number.h"
#include "../variant.h"
#include "tune.h"

namespace oclair::tune {
namespace {

// To two digits, so that a user can type it.
float two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return static_cast<float>(parse_number(text).value_or(value));
}

}  // namespace

std::vector<Choices> candidates(const Scene& scene, int bvh_width, double mean) {
  std::vector<Choices> all;
  const auto add = [&](auto change) { change(all.emplace_back()); };
  const auto has = [&](Features some) { return (scene.features & some) != 0; };
  const Settings& settings = scene.settings;

  if (has(FEATURE_DIELECTRIC | FEATURE_THIN_DIELECTRIC | FEATURE_CONDUCTOR)) add([](Choices& c) { c.fresnel = Fresnel::schlick; });
  if (has(FEATURE_OREN_NAYAR)) add([](Choices& c) { c.oren_nayar = OrenNayar::qualitative; });
  for (const uint depth : {2u, 4u, 8u, 16u})
    if (depth < settings.max_depth) add([=](Choices& c) { c.max_depth = depth; });
  for (const uint depth : {2u, 16u})  // a path that has more segments than that is needed for it to matter
    if (depth != settings.rr_depth && std::min(depth, settings.rr_depth) < settings.max_depth) add([=](Choices& c) { c.rr_depth = depth; });
  const bool scatters = has(FEATURE_DIFFUSE | FEATURE_OREN_NAYAR | FEATURE_OREN_NAYAR_FAST | FEATURE_DISNEY);
  if (scatters && has(FEATURE_TRIANGLE_LIGHTS | FEATURE_QUADRIC_LIGHTS | FEATURE_CONSTANT_LIGHT | FEATURE_ENVIRONMENT_MAP))
    add([](Choices& c) { c.light_sampling = LightSampling::bsdf; });
  add([&](Choices& c) { c.sampler = settings.sampler == SAMPLER_SOBOL ? SAMPLER_INDEPENDENT : SAMPLER_SOBOL; });
  if (mean > 0.0)
    for (const double times : {4.0, 16.0, 64.0})
      if (const float limit = two_digits(times * mean); std::isnormal(limit)) add([=](Choices& c) { c.clamp = limit; });
  if (variant_features(variant_of(scene.features), scene.features) != scene.features) add([](Choices& c) { c.kernels = Kernels::exact; });
  add([=](Choices& c) { c.bvh_width = bvh_width == 8 ? 4 : 8; });
  return all;
}

}  // namespace oclair::tune
