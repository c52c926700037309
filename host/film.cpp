#include "film.h"

#include <cmath>

namespace oclair {
namespace {

// An unsigned integer of some 64-bit limbs, least significant first, times 2^exponent. long double holds 64 bits: one
// rounding of the two leading limbs that matter.
long double value(const ulong* limbs, int count, int exponent) {
  long double sum = 0.0L;
  for (int i = count - 1; i >= 0; --i) sum = sum * 18446744073709551616.0L + static_cast<long double>(limbs[i]);
  return std::ldexp(sum, exponent);
}

std::uint64_t accepted(const Film& film, std::size_t pixel) { return film.samples - film.pixels[pixel].rejected; }

}  // namespace

std::array<double, 3> pixel_mean(const Film& film, std::size_t pixel) {
  std::array<double, 3> mean{};
  const std::uint64_t n = accepted(film, pixel);
  for (int c = 0; c < 3 && n > 0; ++c)
    mean[c] = static_cast<double>(value(film.pixels[pixel].sum[c], 2, film.exponent - FILM_FRACTION_BITS) /
                                  static_cast<long double>(n));
  return mean;
}

glm::dmat3 pixel_mean_products(const Film& film, std::size_t pixel) {
  glm::dmat3 mean(0.0);
  const std::uint64_t n = accepted(film, pixel);
  for (int a = 0; a < 3 && n > 0; ++a)
    for (int b = 0; b < 3; ++b)
      mean[a][b] = static_cast<double>(value(film.moments[pixel].product[MOMENT_INDEX(a, b)], 3,
                                             2 * (film.exponent - FILM_MOMENT_FRACTION_BITS)) /
                                       static_cast<long double>(n));
  return mean;
}

std::optional<std::array<double, 3>> pixel_standard_error(const Film&, std::size_t) { return std::nullopt; }

double pixel_alpha(const Film& film, std::size_t pixel) {
  const std::uint64_t n = accepted(film, pixel);
  return n > 0 ? static_cast<double>(film.pixels[pixel].hits) / static_cast<double>(n) : 0.0;
}

std::uint64_t rejected_samples(const Film& film) {
  std::uint64_t sum = 0;
  for (const FilmPixel& pixel : film.pixels) sum += pixel.rejected;
  return sum;
}

}  // namespace oclair
