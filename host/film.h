// From the film's exact sums to numbers.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "render.h"

namespace oclair {

// Mean radiance of a pixel over its accepted samples, W/(m^2 sr); 0 without any. Rounded three times: the sum to 64 bits, the quotient, and to double.
std::array<double, 3> pixel_mean(const Film& film, std::size_t pixel);

// Mean of the products of the channels, red, green, blue by red, green, blue: the second moments. Only if the film has them.
glm::dmat3 pixel_mean_products(const Film& film, std::size_t pixel);

// Standard error of that mean, per channel, in the same units; nothing with fewer than two whole replicas.
std::optional<std::array<double, 3>> pixel_standard_error(const Film& film, std::size_t pixel);

// Share of the accepted samples that met something, in [0, 1].
double pixel_alpha(const Film& film, std::size_t pixel);

// Samples left out in all pixels: not finite, negative, or too large.
std::uint64_t rejected_samples(const Film& film);

}  // namespace oclair
