// The film as the named layers of an image file.
#pragma once

#include <string>
#include <vector>

#include "render.h"
#include "world.h"

namespace oclair {

// One channel: a value per pixel, row by row over the crop window.
struct Layer {
  std::string name;
  std::vector<float> values;
};

// The channels of the pixel format (R G B, Y or X Y Z, and A), then, where the film has moments, those of Mitsuba's moment
// integrator: the mean and the mean square of CIE X, Y and Z, called <moment_name>.X and m2_<moment_name>.X.
std::vector<Layer> layers_of(const Film& film, PixelFormat format, const std::string& moment_name);

// Linear sRGB of each pixel, three floats a pixel.
std::vector<float> rgb_of(const Film& film);

}  // namespace oclair
