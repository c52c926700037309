// Image files: the render as OpenEXR, a picture of it as PNG. Whatever fails, no partial file stays behind and an older file of
// that name stays as it was (file_aside.h). Failures are Error(Exit::render_failed).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "file_aside.h"

namespace oclair {

// The pixels of a file as a part of the full film; what lies outside is not stored.
struct ImageWindow {
  unsigned film_width, film_height;
  unsigned crop_x, crop_y;
  unsigned crop_width, crop_height;
};

// Sets the values of all channels of a pixel; pixels count row by row over the crop window. Called by several threads at once.
template <class Value>
using ValuesOfPixel = std::function<void(std::size_t pixel, std::span<Value> values)>;

// Channels that belong together. In the file floats are FLOAT and integers are UINT, both of 32 bits.
struct ImagePart {
  std::string name;                   // unlike those of the other parts
  std::vector<std::string> channels;  // full names, "layer.channel" or a standard one; no two are alike
  std::variant<ValuesOfPixel<float>, ValuesOfPixel<std::uint32_t>> values;  // in the order of the channels
  std::function<void(std::size_t first, std::size_t end)> written{};        // is told, if there, of pixels that are done
};

// Sets red, green and blue of consecutive pixels, which count row by row.
using RgbOfPixels = std::function<void(std::size_t first, std::span<float> rgb)>;

using ImageAttributes = std::vector<std::pair<std::string, std::variant<std::string, int, float>>>;

// Scan lines, ZIP (lossless: infinities and NaNs too), with sRGB's primaries as chromaticities; the attributes stand in the
// first part. One part alone makes a file that is not multi-part. Takes memory for some rows at a time.
void write_exr(const std::filesystem::path& path, const ImageWindow& window, const std::vector<ImagePart>& parts,
               const ImageAttributes& attributes = {});

// 8-bit sRGB of a picture in linear sRGB: srgb_encoded(tone_mapped(x)), rounded to nearest; NaN becomes black. Asks for rows from top
// to bottom, some at a time.
void write_png(const std::filesystem::path& path, unsigned width, unsigned height, const RgbOfPixels& rgb);

// The bytes of the same file.
std::string encoded_png(unsigned width, unsigned height, const RgbOfPixels& rgb);

// [-inf, inf] to [0, 1]: x up to the knee at 0.8, then 0.8 + 0.2 (1 - exp(-(x - 0.8) / 0.2)), whose slope at the knee is 1.
double tone_mapped(double linear);

// The transfer curve of IEC 61966-2-1, for values in [0, 1].
double srgb_encoded(double linear);

}  // namespace oclair
