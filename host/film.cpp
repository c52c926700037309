#include "film.h"

#include <algorithm>
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

double square(const std::array<double, 3>& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

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

// Of n replicas of R samples with sums S_k, T = sum S_k and Q = sum S_k^2, the variance of a replica's sum is estimated without
// bias by s^2 = (Q - T^2/n)/(n - 1), whatever a replica's samples have to do with each other, because replicas are independent.
// T/(n R) then has the variance s^2/(n R^2). pixel_mean divides by the accepted samples instead, which the last factor is for.
//
// T is exact, each square is rounded to 2^(2 (exponent - FILM_SQUARE_FRACTION_BITS)), and the difference loses T^2/n 2^-63 to
// the 64 bits of long double: a relative error of the mean below 2^-31/sqrt(n) is not resolved, nor one below
// 2^(exponent - FILM_SQUARE_FRACTION_BITS)/R.
std::optional<std::array<double, 3>> pixel_standard_error(const Film& film, std::size_t pixel) {
  const std::uint64_t taken = accepted(film, pixel);
  if (film.replicas < 2 || taken == 0) return {};
  const long double n = static_cast<long double>(film.replicas);
  const long double scale = static_cast<long double>(film.samples) / (static_cast<long double>(taken) * REPLICA_SAMPLES);
  std::array<double, 3> error{};
  for (int c = 0; c < 3; ++c) {
    const FilmErrors& sums = film.errors[pixel];
    const long double total = value(sums.sum[c], 2, film.exponent - FILM_FRACTION_BITS);
    const long double squares = value(sums.square[c], 3, 2 * (film.exponent - FILM_SQUARE_FRACTION_BITS));
    const long double variance = std::max(0.0L, squares - total * total / n) / (n - 1.0L);
    error[c] = static_cast<double>(std::sqrt(variance / n) * scale);
  }
  return error;
}

// Q is the sum of n squares that were rounded by half of their unit each: s^2/(n R^2) errs by (n/2)/((n - 1) n R^2) of it.
double standard_error_unit(const Film& film) {
  const double spread = 2.0 * (static_cast<double>(film.replicas) - 1.0);
  return std::ldexp(1.0, film.exponent - FILM_SQUARE_FRACTION_BITS) / REPLICA_SAMPLES / std::sqrt(spread);
}

void ImageError::add_to_mean(const Film& film, std::size_t pixel) {
  const auto mean = pixel_mean(film, pixel);
  for (int c = 0; c < 3; ++c) mean_[c] += mean[c] / count_;
}

void ImageError::add_to_error(const Film& film, std::size_t pixel) {
  if (const auto error = pixel_standard_error(film, pixel)) sum_ += square(*error) / (square(pixel_mean(film, pixel)) + floor());
  else complete_ = false;
}

double ImageError::floor() const { return 0.01 * square(mean_); }

std::optional<double> ImageError::result() const {
  return complete_ && floor() > 0.0 ? std::optional(std::sqrt(sum_ / count_)) : std::nullopt;
}

std::optional<double> image_error(const Film& film) {
  if (film.replicas < 2) return std::nullopt;
  ImageError error(film.pixels.size());
  for_each_element(film.pixels.size(), [&](std::size_t i) { error.add_to_mean(film, i); }, film);
  for_each_element(film.pixels.size(), [&](std::size_t i) { error.add_to_error(film, i); }, film);
  return error.result();
}

double pixel_alpha(const Film& film, std::size_t pixel) {
  const std::uint64_t n = accepted(film, pixel);
  return n > 0 ? static_cast<double>(film.pixels[pixel].hits) / static_cast<double>(n) : 0.0;
}

std::uint64_t rejected_samples(const Film& film) {
  std::uint64_t sum = 0;
  for_each_element(film.pixels.size(), [&](std::size_t i) { sum += film.pixels[i].rejected; }, film);
  return sum;
}

}  // namespace oclair
