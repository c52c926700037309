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

// Standard error of pixel_mean, from the spread of the replicas; nothing with fewer than two complete ones. What an unfinished replica
// adds to the mean is left out of it: the error is that of the mean over the complete ones.
std::optional<std::array<double, 3>> pixel_standard_error(const Film& film, std::size_t pixel);

// What the rounding of squares can take from a standard error s, or give to it: that of the exact sums has a square between s^2 - u^2 and
// s^2 + u^2, but for relative errors of 2^-31/sqrt(n) of the mean. Of at least 2 replicas, where no sample was rejected.
double standard_error_unit(const Film& film);

// Standard error of the whole image: the root of the mean over its pixels of |s|^2/(|mu|^2 + 0.01 |m|^2), with s from pixel_standard_error,
// mu from pixel_mean and m the mean of all mu, |.| over the three channels. It estimates the error that stopping.h defines; nothing
// with fewer than two complete replicas, for a black image, or where a pixel has no accepted sample.
std::optional<double> image_error(const Film& film);

// The same of a film that is seen pixel by pixel, twice.
class ImageError {
 public:
  explicit ImageError(std::size_t pixels) : count_(static_cast<double>(pixels)) {}
  void add_to_mean(const Film& film, std::size_t pixel);   // every pixel,
  void add_to_error(const Film& film, std::size_t pixel);  // and then every one again
  std::optional<double> result() const;

 private:
  double floor() const;

  double count_, sum_ = 0.0;
  std::array<double, 3> mean_{};
  bool complete_ = true;
};

// Share of the accepted samples that met something, in [0, 1].
double pixel_alpha(const Film& film, std::size_t pixel);

// Samples left out in all pixels: not finite, negative, or too large.
std::uint64_t rejected_samples(const Film& film);

}  // namespace oclair
