// The image of an environment map as a distribution over directions, for cl/environment.h.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "world.h"

namespace oclair {

struct EnvironmentDistribution {
  std::vector<uint> cdf;                // see cl/environment.h
  glm::dvec3 integral{0.0};             // of the radiance over the sphere, each channel
  double brightest = 0.0;               // of all texels and channels
};

// The image's texels are finite and not negative, and not all of them 0.
EnvironmentDistribution environment_distribution(const Image& image);

}  // namespace oclair
