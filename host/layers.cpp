#include "layers.h"

#include <functional>
#include <glm/gtc/matrix_access.hpp>

#include "film.h"

namespace oclair {
namespace {

// Linear sRGB to CIE XYZ, white D65 (IEC 61966-2-1).
const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(0.412453, 0.357580, 0.180423,  //
                                                        0.212671, 0.715160, 0.072169,  //
                                                        0.019334, 0.119193, 0.950227));

glm::dvec3 rgb(const Film& film, std::size_t pixel) {
  const auto mean = pixel_mean(film, pixel);
  return {mean[0], mean[1], mean[2]};
}

Layer layer(const Film& film, const std::string& name, const std::function<double(std::size_t)>& value) {
  Layer result{name, std::vector<float>(film.pixels.size())};
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] = static_cast<float>(value(i));
  return result;
}

}  // namespace

std::vector<Layer> layers_of(const Film& film, PixelFormat format, const std::string& moment_name) {
  std::vector<Layer> layers;
  const auto add = [&](const std::string& name, const std::function<double(std::size_t)>& value) {
    layers.push_back(layer(film, name, value));
  };
  const char* const axes[] = {"X", "Y", "Z"};
  const char* const colours[] = {"R", "G", "B"};
  const auto xyz = [&](std::size_t pixel, int c) { return (xyz_of_rgb * rgb(film, pixel))[c]; };
  const bool luminance = format == PixelFormat::luminance || format == PixelFormat::luminance_alpha;
  const bool is_xyz = format == PixelFormat::xyz || format == PixelFormat::xyza;
  for (int c = 0; c < 3; ++c) {
    if (luminance && c != 1) continue;
    if (luminance || is_xyz) add(axes[c], [&, c](std::size_t pixel) { return xyz(pixel, c); });
    else add(colours[c], [&, c](std::size_t pixel) { return rgb(film, pixel)[c]; });
  }
  if (format == PixelFormat::luminance_alpha || format == PixelFormat::rgba || format == PixelFormat::xyza)
    add("A", [&](std::size_t pixel) { return pixel_alpha(film, pixel); });
  if (film.moments.empty()) return layers;
  for (int c = 0; c < 3; ++c) add(moment_name + "." + axes[c], [&, c](std::size_t pixel) { return xyz(pixel, c); });
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 weights = glm::row(xyz_of_rgb, c);
    add("m2_" + moment_name + "." + axes[c], [&, weights](std::size_t pixel) {
      const glm::dmat3 products = pixel_mean_products(film, pixel);
      return glm::dot(weights, products * weights);
    });
  }
  return layers;
}

std::vector<float> rgb_of(const Film& film) {
  std::vector<float> values;
  values.reserve(3 * film.pixels.size());
  for (std::size_t i = 0; i < film.pixels.size(); ++i)
    for (double c : pixel_mean(film, i)) values.push_back(static_cast<float>(c));
  return values;
}

}  // namespace oclair
