#include "choices.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "error.h"
#include "header.h"
#include "number.h"

namespace oclair {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& given, const std::string& expected) {
  throw Error(Exit::usage, option + " '" + one_line(given) + "': expected " + expected);
}

uint whole(const std::string& option, const std::string& given, std::int64_t least, std::int64_t most) {
  const auto number = parse_integer(given);
  if (!number || *number < least || *number > most)
    refuse(option, given, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<uint>(*number);
}

// Names of the values of an enum, in its order.
template <class Value, std::size_t count>
Value named(const std::array<const char*, count>& names, const std::string& option, const std::string& given) {
  for (std::size_t i = 0; i < count; ++i)
    if (given == names[i]) return static_cast<Value>(i);
  std::string expected;
  for (std::size_t i = 0; i < count; ++i) expected += (i == 0 ? "" : i + 1 == count ? " or " : ", ") + std::string(names[i]);
  refuse(option, given, expected);
}

constexpr std::array fresnel_names{"exact", "schlick"};
constexpr std::array oren_nayar_names{"full", "qualitative"};
constexpr std::array light_sampling_names{"both", "bsdf"};
constexpr std::array kernel_names{"shared", "exact"};
constexpr std::array arithmetic_names{"float", "double"};

template <class Value, std::size_t count>
std::string name_in(const std::array<const char*, count>& names, const std::optional<Value>& value) {
  return value ? names[static_cast<std::size_t>(*value)] : "";
}

std::string text(const std::optional<uint>& number) { return number ? std::to_string(*number) : ""; }

constexpr std::int64_t most_segments = std::numeric_limits<uint>::max();

const Choice all[] = {
    {"fresnel", "exact|schlick", "reflectance of dielectrics and conductors: exact, or Schlick's approximation; default: exact", Effect::bias,
     [](const Choices& c) { return name_in(fresnel_names, c.fresnel); },
     [](Choices& c, const std::string& given, const std::string& option) { c.fresnel = named<Fresnel>(fresnel_names, option, given); }},
    {"oren-nayar", "full|qualitative", "model of all Oren-Nayar surfaces; default: as the scene says", Effect::bias,
     [](const Choices& c) { return name_in(oren_nayar_names, c.oren_nayar); },
     [](Choices& c, const std::string& given, const std::string& option) {
       c.oren_nayar = named<OrenNayar>(oren_nayar_names, option, given);
     }},
    {"max-depth", "N", "longest path, in segments; 1: directly visible light only; default: as the scene says", Effect::bias,
     [](const Choices& c) { return text(c.max_depth); },
     [](Choices& c, const std::string& given, const std::string& option) { c.max_depth = whole(option, given, 0, most_segments); }},
    {"rr-depth", "N", "segments after which Russian roulette begins; default: as the scene says", Effect::noise,
     [](const Choices& c) { return text(c.rr_depth); },
     [](Choices& c, const std::string& given, const std::string& option) { c.rr_depth = whole(option, given, 1, most_segments); }},
    {"light-sampling", "both|bsdf", "how lights are found: by scattering and by sampling them, or by scattering where that can be; default: both", Effect::noise,
     [](const Choices& c) { return name_in(light_sampling_names, c.light_sampling); },
     [](Choices& c, const std::string& given, const std::string& option) {
       c.light_sampling = named<LightSampling>(light_sampling_names, option, given);
     }},
    {"sampler", "independent|sobol", "random numbers: independent ones, or scrambled Sobol points; default: sobol", Effect::noise,
     [](const Choices& c) { return c.sampler ? std::string(name_of(*c.sampler)) : ""; },
     [](Choices& c, const std::string& given, const std::string& option) {
       for (const SamplerKind kind : {SAMPLER_INDEPENDENT, SAMPLER_SOBOL})
         if (given == name_of(kind)) return void(c.sampler = kind);
       refuse(option, given, "independent or sobol");
     }},
    {"clamp", "RADIANCE", "brighter samples are scaled down to it, which loses light; default: none is", Effect::bias,
     [](const Choices& c) {
       char digits[32];
       return c.clamp ? std::string(digits, std::to_chars(digits, digits + sizeof digits, *c.clamp).ptr) : "";
     },
     [](Choices& c, const std::string& given, const std::string& option) {
       const auto number = parse_number(given);
       const float limit = number ? static_cast<float>(*number) : 0.0f;
       if (!(limit >= std::numeric_limits<float>::min()) || limit > std::numeric_limits<float>::max())
         refuse(option, given, "a number from 1.2e-38 to 3.4e38");
       c.clamp = limit;
     }},
    {"kernels", "shared|exact",
     "shared: the smallest of four kernels that holds what the scene needs; exact: one with just that; default: shared", Effect::none,
     [](const Choices& c) { return name_in(kernel_names, c.kernels); },
     [](Choices& c, const std::string& given, const std::string& option) { c.kernels = named<Kernels>(kernel_names, option, given); }},
    {"arithmetic", "float|double",
     "what the samples are computed in: an image in double shows, by comparison, where rounding counts; default: float", Effect::bias,
     [](const Choices& c) { return name_in(arithmetic_names, c.arithmetic); },
     [](Choices& c, const std::string& given, const std::string& option) {
       c.arithmetic = named<Arithmetic>(arithmetic_names, option, given);
     }},
    {"bvh-width", "4|8", "children of a node; the image is the same; default: 8 on CPUs, 4 elsewhere", Effect::none,
     [](const Choices& c) { return c.bvh_width ? std::to_string(*c.bvh_width) : ""; },
     [](Choices& c, const std::string& given, const std::string& option) {
       if (given != "4" && given != "8") refuse(option, given, "4 or 8");
       c.bvh_width = given == "4" ? 4 : 8;
     }},
};

}  // namespace

std::span<const Choice> choices() { return all; }

const Choice* find_choice(const std::string& name) {
  const auto found = std::find_if(std::begin(all), std::end(all), [&](const Choice& choice) { return name == choice.name; });
  return found == std::end(all) ? nullptr : found;
}

std::string text_of(const Choices& given) {
  std::string words;
  for (const Choice& choice : all)
    if (const std::string value = choice.get(given); !value.empty()) words += (words.empty() ? "" : " ") + (choice.name + ("=" + value));
  return words.empty() ? "none" : words;
}

Choices joined(const Choices& a, const Choices& b) {
  Choices both = a;
  for (const Choice& choice : all)
    if (const std::string value = choice.get(b); !value.empty()) choice.set(both, value, choice.name);
  return both;
}

void apply(const Choices& given, Scene& scene) {
  Settings& settings = scene.settings;
  if (given.max_depth) settings.max_depth = *given.max_depth;
  if (given.rr_depth) settings.rr_depth = *given.rr_depth;
  if (given.sampler) {
    settings.sampler = *given.sampler;
    scene.features = (scene.features & ~FEATURE_SOBOL) | (*given.sampler == SAMPLER_SOBOL ? FEATURE_SOBOL : 0);
  }
  constexpr Features oren_nayar = FEATURE_OREN_NAYAR | FEATURE_OREN_NAYAR_FAST;
  if (given.oren_nayar && (scene.features & oren_nayar)) {
    const bool full = *given.oren_nayar == OrenNayar::full;
    for (Material& material : scene.materials)
      if (material.kind == MATERIAL_OREN_NAYAR || material.kind == MATERIAL_OREN_NAYAR_FAST)
        material.kind = full ? MATERIAL_OREN_NAYAR : MATERIAL_OREN_NAYAR_FAST;
    scene.features = (scene.features & ~oren_nayar) | (full ? FEATURE_OREN_NAYAR : FEATURE_OREN_NAYAR_FAST);
  }
  constexpr Features with_fresnel = FEATURE_CONDUCTOR | FEATURE_DIELECTRIC | FEATURE_THIN_DIELECTRIC;
  if (given.fresnel == Fresnel::schlick && (scene.features & with_fresnel)) scene.approximations |= APPROXIMATION_SCHLICK;
  constexpr Features found_both_ways = FEATURE_TRIANGLE_LIGHTS | FEATURE_QUADRIC_LIGHTS | FEATURE_CONSTANT_LIGHT | FEATURE_ENVIRONMENT_MAP;
  if (given.light_sampling == LightSampling::bsdf && (scene.features & found_both_ways)) scene.approximations |= APPROXIMATION_BSDF_SAMPLING;
  if (given.clamp) {
    scene.approximations |= APPROXIMATION_CLAMP;
    settings.largest_sample = *given.clamp;
  }
  scene.exact_kernel = given.kernels == Kernels::exact;
  scene.double_precision = given.arithmetic == Arithmetic::double_precision;
}

int bvh_width(const Choices& given, const Device& device) { return given.bvh_width.value_or(device.bvh_width); }

}  // namespace oclair
