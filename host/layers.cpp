#include "layers.h"

#include <bit>
#include <glm/gtc/matrix_access.hpp>
#include <limits>

#include "film.h"

namespace oclair {
namespace {

// Linear sRGB to CIE XYZ, white D65 (IEC 61966-2-1).
const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(0.412453, 0.357580, 0.180423,  //
                                                        0.212671, 0.715160, 0.072169,  //
                                                        0.019334, 0.119193, 0.950227));

struct ColourFormat {
  bool luminance, xyz, alpha;
};

ColourFormat colour_format(PixelFormat format) {
  return {format == PixelFormat::luminance || format == PixelFormat::luminance_alpha,
          format == PixelFormat::xyz || format == PixelFormat::xyza,
          format == PixelFormat::luminance_alpha || format == PixelFormat::rgba || format == PixelFormat::xyza};
}

ImagePart colour_part(const Film& film, PixelFormat pixel_format, const std::string& moment_name) {
  const ColourFormat format = colour_format(pixel_format);
  ImagePart part;
  part.name = format.luminance ? "y" : format.xyz ? "xyz" : "rgb";
  if (format.luminance)
    part.channels = {"Y"};
  else if (format.xyz)
    part.channels = {"X", "Y", "Z"};
  else
    part.channels = {"R", "G", "B"};
  if (format.alpha) {
    part.name += "a";
    part.channels.push_back("A");
  }
  const bool moments = !film.moments.empty();
  if (moments)
    for (const char* prefix : {"", "m2_"})
      for (const char* axis : {".X", ".Y", ".Z"}) part.channels.push_back(prefix + moment_name + axis);
  part.values = ValuesOfPixel<float>([&film, format, moments](std::size_t pixel, std::span<float> values) {
    std::size_t channel = 0;
    const auto add = [&](double value) { values[channel++] = static_cast<float>(value); };
    const auto mean = pixel_mean(film, pixel);
    const glm::dvec3 rgb(mean[0], mean[1], mean[2]), xyz = xyz_of_rgb * rgb;
    if (format.luminance)
      add(xyz.y);
    else
      for (int c = 0; c < 3; ++c) add(format.xyz ? xyz[c] : rgb[c]);
    if (format.alpha) add(pixel_alpha(film, pixel));
    if (!moments) return;
    for (int c = 0; c < 3; ++c) add(xyz[c]);
    const glm::dmat3 products = pixel_mean_products(film, pixel);
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 weights = glm::row(xyz_of_rgb, c);
      add(glm::dot(weights, products * weights));
    }
  });
  return part;
}

// Of red, green and blue, whatever the format of the colour: that of a combination of them would need their covariances.
ImagePart error_part(const Film& film) {
  return {"standardError",
          {"standardError.R", "standardError.G", "standardError.B"},
          ValuesOfPixel<float>([&film](std::size_t pixel, std::span<float> values) {
            const auto error = pixel_standard_error(film, pixel);
            for (std::size_t c = 0; c < 3; ++c)
              values[c] = error ? static_cast<float>((*error)[c]) : std::numeric_limits<float>::infinity();
          })};
}

// Samples that the pixel is the mean of. An exact integer as long as 32 bits hold it.
ImagePart count_part(const Film& film) {
  const auto count = [&film](std::size_t pixel) { return film.samples - film.pixels[pixel].rejected; };
  ImagePart part{"sampleCount", {"sampleCount.Y"}, {}};
  if (film.samples <= std::numeric_limits<std::uint32_t>::max())
    part.values = ValuesOfPixel<std::uint32_t>([count](std::size_t pixel, std::span<std::uint32_t> values) {
      values[0] = static_cast<std::uint32_t>(count(pixel));
    });
  else
    part.values = ValuesOfPixel<float>(
        [count](std::size_t pixel, std::span<float> values) { values[0] = static_cast<float>(count(pixel)); });
  return part;
}

std::string part_name(const Layer& layer) { return layer.name.substr(0, layer.name.rfind('.')); }

// Of layers whose names begin alike.
ImagePart layer_part(std::span<const Layer> layers) {
  ImagePart part{part_name(layers.front()), {}, {}};
  for (const Layer& layer : layers) part.channels.push_back(layer.name);
  if (holds_integers(layers.front()))
    part.values = ValuesOfPixel<std::uint32_t>([layers](std::size_t pixel, std::span<std::uint32_t> values) {
      for (std::size_t c = 0; c < layers.size(); ++c) values[c] = std::bit_cast<std::uint32_t>(layers[c].values[pixel]);
    });
  else
    part.values = ValuesOfPixel<float>([layers](std::size_t pixel, std::span<float> values) {
      for (std::size_t c = 0; c < layers.size(); ++c) values[c] = layers[c].values[pixel];
    });
  return part;
}

}  // namespace

bool holds_integers(const Layer& layer) { return layer.name.ends_with(".id"); }

std::vector<ImagePart> parts_of(const Film& film, PixelFormat format, const std::string& moment_name,
                                const std::vector<Layer>& layers) {
  std::vector<ImagePart> parts = {colour_part(film, format, moment_name)};
  const auto any_pixel = [&film](auto holds) {
    bool any = false;
    for_each_element(film.pixels.size(), [&](std::size_t i) { any = any || holds(i); }, film);
    return any;
  };
  if (film.replicas >= 2 && any_pixel([&](std::size_t i) { return pixel_standard_error(film, i).has_value(); })) parts.push_back(error_part(film));
  if (any_pixel([&](std::size_t i) { return film.pixels[i].rejected != film.pixels[0].rejected; }))
    parts.push_back(count_part(film));
  for (ImagePart& part : parts) part.written = [&film](std::size_t first, std::size_t end) { release(film, first, end); };
  for (std::size_t first = 0, end; first < layers.size(); first = end) {
    for (end = first + 1; end < layers.size() && part_name(layers[end]) == part_name(layers[first]);) ++end;
    parts.push_back(layer_part({layers.data() + first, end - first}));
  }
  return parts;
}

RgbOfPixels rgb_of(const Film& film) {
  return [&film](std::size_t first, std::span<float> rgb) {
    for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
      const auto mean = pixel_mean(film, first + i);
      for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<float>(mean[c]);
    }
    release(film, first, first + rgb.size() / 3);
  };
}

}  // namespace oclair
