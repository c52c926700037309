// The film, and what lies beside it, as the parts of an image file: docs/image-files.md.
#pragma once

#include <string>
#include <vector>

#include "image.h"
#include "render.h"
#include "world.h"

namespace oclair {

// One channel that does not come from the film: a value per pixel, row by row over the crop window.
struct Layer {
  std::string name;           // "albedo.R"
  std::vector<float> values;  // of a channel "id": integers, as their bits
};

// Whether its values are the bits of integers.
bool holds_integers(const Layer& layer);

// The parts of the file; they read film and layers when they are written. First the colour: the channels of the pixel format
// (R G B, Y or X Y Z, and A), then, where the film has moments, those of Mitsuba's moment integrator: the mean and the mean
// square of CIE X, Y and Z, called <moment_name>.X and m2_<moment_name>.X. Then "standardError", where the film can tell it,
// "sampleCount" where it varies over the pixels, and the layers, those in one part whose names begin alike.
std::vector<ImagePart> parts_of(const Film& film, PixelFormat format, const std::string& moment_name,
                                const std::vector<Layer>& layers);

// Linear sRGB of the film, which it reads when it is called.
RgbOfPixels rgb_of(const Film& film);

}  // namespace oclair
