// The options of a render that trade speed for accuracy, or noise for time: what `oclair tune` measures and a settings file holds. The list
// stands once, in choices(); absent values are as the scene says, or the accurate default.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "device.h"
#include "scene.h"

namespace oclair {

enum class Fresnel { exact, schlick };
enum class OrenNayar { full, qualitative };
enum class LightSampling { both, bsdf };          // by sampling the lights too, or only where no path can meet them
enum class Kernels { shared, exact };             // variant.h
enum class Arithmetic { single_precision, double_precision };  // of the samples: cl/precision.h

struct Choices {
  std::optional<uint> max_depth, rr_depth;
  std::optional<SamplerKind> sampler;
  std::optional<Fresnel> fresnel;
  std::optional<OrenNayar> oren_nayar;
  std::optional<LightSampling> light_sampling;
  std::optional<float> clamp;  // largest channel of a sample, W/(m^2 sr)
  std::optional<Kernels> kernels;
  std::optional<Arithmetic> arithmetic;
  std::optional<int> bvh_width;
};

// What a choice can do to the image: nothing (the same bits), other noise around the same mean, or another mean.
enum class Effect { none, noise, bias };

struct Choice {
  const char* name;         // of the option, without its dashes
  const char* values;       // as the help shows them
  const char* description;
  Effect effect;
  std::string (*get)(const Choices&);                       // its value as set() takes it; empty: absent
  void (*set)(Choices&, const std::string& given, const std::string& option);  // throws Error(Exit::usage), which calls it `option`
};

std::span<const Choice> choices();

// Null if there is none of that name.
const Choice* find_choice(const std::string& name);

// "fresnel=schlick max-depth=8", those that are set; or "none".
std::string text_of(const Choices& choices);

// All of a and of b; b's where both say something.
Choices joined(const Choices& a, const Choices& b);

// Changes the scene accordingly, once. What the scene has no use for is left out: it is neither compiled nor recorded.
void apply(const Choices& choices, Scene& scene);

int bvh_width(const Choices& choices, const Device& device);

}  // namespace oclair
