// Films whose sums are made on the host, from numbers with a known distribution.
#pragma once

#include <cmath>

#include "../host/render.h"

namespace oclair::test {

inline Film empty_film(uint width, uint height) {
  Film film;
  film.width = width;
  film.height = height;
  film.pixels.assign(std::size_t{width} * height, FilmPixel{});
  return film;
}

// Adds a sum of samples, not negative and below 2^9, to one channel, rounded down to the film's unit. Does not count samples.
inline void add_sum(Film& film, std::size_t pixel, int channel, double sum) {
  const auto units = static_cast<ulong>(std::ldexp(sum, FILM_FRACTION_BITS - film.exponent));
  ulong* const limbs = film.pixels[pixel].sum[channel];
  limbs[0] += units;
  limbs[1] += limbs[0] < units;
}

}  // namespace oclair::test
