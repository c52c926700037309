#include "refractive_indices.h"

#include <algorithm>
#include <cctype>
#include <iterator>

namespace oclair {

namespace {

struct Medium {
  const char* name;
  double index;
};

// The media and values that Mitsuba 3 knows by name; most of them from Hecht, Optics, 4th edition: 0 to 20 degrees
// Celsius, sodium D lines.
constexpr Medium MEDIA[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

}  // namespace

std::optional<double> find_refractive_index(const std::string& name) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto found =
      std::find_if(std::begin(MEDIA), std::end(MEDIA), [&](const Medium& medium) { return lower == medium.name; });
  if (found == std::end(MEDIA)) return std::nullopt;
  return found->index;
}

std::string refractive_index_names() {
  std::string names;
  for (const auto& medium : MEDIA) names += (names.empty() ? "" : ", ") + std::string(medium.name);
  return names;
}

}  // namespace oclair
