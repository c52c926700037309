#include "difference_image.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "color.h"
#include "comparison.h"
#include "image.h"

namespace oclair {
namespace {

using Color = std::array<double, 3>;  // 8-bit sRGB, 0 to 255

// Red and blue have nearly the same luminance, 0.09 and 0.08. All are below the knee of tone_mapped, so that it changes
// none.
constexpr Color ZERO = {225, 225, 225}, ABOVE = {170, 0, 26}, BELOW = {0, 70, 188}, NOT_FINITE = {0, 0, 0};

Color color_of(float difference, double scale) {
  if (!std::isfinite(difference)) return NOT_FINITE;
  const double size = std::abs(double{difference}), share = size == 0.0 ? 0.0 : size < scale ? size / scale : 1.0;
  const Color& end = difference > 0.0f ? ABOVE : BELOW;
  Color color;
  for (std::size_t c = 0; c < 3; ++c) color[c] = ZERO[c] + share * (end[c] - ZERO[c]);
  return color;
}

RgbOfPixels picture(std::span<const float> differences, double scale) {
  return [differences, scale](std::size_t first, std::span<float> rgb) {
    for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
      const Color color = color_of(differences[first + i], scale);
      for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<float>(srgb_decoded(color[c] / 255.0));
    }
  };
}

}  // namespace

std::vector<float> luminance_differences(std::span<const float> a, std::span<const float> b) {
  assert(a.size() == b.size() && a.size() % 3 == 0);
  std::vector<float> differences(a.size() / 3);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const auto color = [i](std::span<const float> image) {
      return glm::dvec3(image[3 * i], image[3 * i + 1], image[3 * i + 2]);
    };
    differences[i] = static_cast<float>(luminance(color(a) - color(b)));
  }
  return differences;
}

double difference_scale(std::span<const float> differences) {
  std::vector<float> sizes;
  sizes.reserve(differences.size());
  for (const float d : differences)
    if (std::isfinite(d) && d != 0.0f) sizes.push_back(std::abs(d));
  return quantiles(std::move(sizes)).p99;
}

void write_difference(const std::filesystem::path& path, unsigned width, unsigned height, std::span<const float> differences,
                      double scale) {
  assert(differences.size() == std::size_t{width} * height);
  write_png(path, width, height, picture(differences, scale));
}

std::string difference_png(unsigned width, unsigned height, std::span<const float> differences, double scale) {
  assert(differences.size() == std::size_t{width} * height);
  return encoded_png(width, height, picture(differences, scale));
}

}  // namespace oclair
