// The picture of a signed difference of two images: light grey where there is none, red above it, blue below, black where it
// is not finite.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace oclair {

// Luminance of a - b, pixel by pixel, of images in linear sRGB with three values a pixel.
std::vector<float> luminance_differences(std::span<const float> a, std::span<const float> b);

// What the deepest red and blue stand for: the 99th percentile of the sizes that are finite and not 0; 0 if there are none.
double difference_scale(std::span<const float> differences);

// As PNG, of a value a pixel, row by row. Colours are linear in 8-bit sRGB from 0 to the scale, and stay there beyond it.
// Throws Error(Exit::render_failed).
void write_difference(const std::filesystem::path& path, unsigned width, unsigned height, std::span<const float> differences,
                      double scale);

// The bytes of the same file.
std::string difference_png(unsigned width, unsigned height, std::span<const float> differences, double scale);

}  // namespace oclair
