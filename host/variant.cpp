#include "variant.h"

#include <algorithm>

namespace oclair {
namespace {

struct Entry {
  Features feature;
  Variant variant;
};

#define FEATURE_ENTRY(name, bit, variant, description) {FEATURE_##name, Variant::variant},
constexpr Entry entries[] = {FEATURE_LIST(FEATURE_ENTRY)};
#undef FEATURE_ENTRY

}  // namespace

std::string_view name_of(Variant variant) {
  constexpr std::string_view names[] = {"PLAIN", "SURFACES", "TEXTURED", "FULL", "ALONE"};
  return names[static_cast<int>(variant)];
}

Variant variant_of(Features scene) {
  Variant least = Variant::PLAIN;
  for (const Entry& entry : entries)
    if ((scene & entry.feature) && entry.variant != Variant::ALONE) least = std::max(least, entry.variant);
  return least;
}

Features variant_features(Variant variant, Features scene) {
  Features features = 0;
  for (const Entry& entry : entries)
    if (entry.variant == Variant::ALONE ? (scene & entry.feature) != 0 : entry.variant <= variant) features |= entry.feature;
  return features;
}

}  // namespace oclair
