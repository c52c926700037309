// The film, and what lies beside it, as the parts of an image file: docs/image-files.md.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "image.h"
#include "render.h"
#include "world.h"

namespace oclair {

// Values that do not come from the film, such as those of aov.h: some channels for each pixel, row by row over the crop window.
struct Layer {
  std::string name;
  std::vector<std::string> channels;  // without the layer's name
  std::variant<std::vector<float>, std::vector<std::uint32_t>> values;  // of the channels of pixel 0, then of pixel 1, ...
};

// The parts of the file; they read film and layers when they are written. First the colour: the channels of the pixel format
// (R G B, Y or X Y Z, and A), then, where the film has moments, those of Mitsuba's moment integrator: the mean and the mean
// square of CIE X, Y and Z, called <moment_name>.X and m2_<moment_name>.X. Then "standardError", where the film can tell it,
// "sampleCount" where it varies over the pixels, and the layers.
std::vector<ImagePart> parts_of(const Film& film, PixelFormat format, const std::string& moment_name,
                                const std::vector<Layer>& layers);

// Linear sRGB of each pixel, three floats a pixel.
std::vector<float> rgb_of(const Film& film);

}  // namespace oclair
