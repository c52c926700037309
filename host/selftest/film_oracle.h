// The film's sums in integers of the host, from the same float samples.
#pragma once

#include <array>
#include <cmath>

#include "random.h"

namespace oclair::test {

__extension__ typedef unsigned __int128 Uint128;
using Wide = std::array<ulong, 3>;

inline Wide plus(Wide a, const Wide& b) {
  unsigned carry = 0;
  for (int i = 0; i < 3; ++i) {
    const Uint128 sum = static_cast<Uint128>(a[i]) + b[i] + carry;
    a[i] = static_cast<ulong>(sum);
    carry = static_cast<unsigned>(sum >> 64);
  }
  return a;
}

// x, not negative, rounded to the nearest integer, ties up. x has at most 48 significant bits, long double 64: x + 1/2 is exact
// where it matters, and so is everything else.
inline Wide rounded(long double x) {
  if (x < 0x1p52L) x = std::floor(x + 0.5L);
  Wide limbs;
  limbs[2] = static_cast<ulong>(std::floor(std::ldexp(x, -128)));
  x -= std::ldexp(static_cast<long double>(limbs[2]), 128);
  limbs[1] = static_cast<ulong>(std::floor(std::ldexp(x, -64)));
  x -= std::ldexp(static_cast<long double>(limbs[1]), 64);
  limbs[0] = static_cast<ulong>(x);
  return limbs;
}

// The square of x in units of a square of the film, rounded to the nearest, ties up: in digits of 32 bits, as on paper.
inline Wide rounded_square(Uint128 x) {
  constexpr int shift = 2 * (FILM_FRACTION_BITS - FILM_SQUARE_FRACTION_BITS);
  std::array<ulong, 9> digit{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const ulong product = static_cast<ulong>(static_cast<uint>(x >> (32 * i))) * static_cast<uint>(x >> (32 * j));
      digit[i + j] += static_cast<uint>(product);
      digit[i + j + 1] += product >> 32;
    }
  digit[(shift - 1) / 32] += ulong{1} << ((shift - 1) % 32);
  for (std::size_t i = 0; i + 1 < digit.size(); ++i) {
    digit[i + 1] += digit[i] >> 32;
    digit[i] &= 0xffffffffu;
  }
  Wide limbs{};
  for (int bit = 0; bit < 192; ++bit)
    limbs[bit / 64] |= (digit[(bit + shift) / 32] >> ((bit + shift) % 32) & 1) << (bit % 64);
  return limbs;
}

inline Uint128 narrow(const Wide& x) { return static_cast<Uint128>(x[1]) << 64 | x[0]; }

struct Sums {
  std::array<Wide, 3> sum{};
  std::array<std::array<Wide, 3>, 3> product{};
  ulong rejected = 0, hits = 0;
};

inline bool acceptable(float x, int exponent) {
  return std::isfinite(x) && x >= 0.0f && static_cast<long double>(x) < std::ldexp(1.0L, exponent + FILM_HEADROOM_BITS);
}

inline Sums expected_sums(const packed_float3* samples, std::size_t n, int exponent) {
  Sums s;
  for (std::size_t k = 0; k < n; ++k) {
    const float x[3] = {samples[k].x, samples[k].y, samples[k].z};
    if (!acceptable(x[0], exponent) || !acceptable(x[1], exponent) || !acceptable(x[2], exponent)) {
      ++s.rejected;
      continue;
    }
    s.hits += k % 2 == 0;
    for (int a = 0; a < 3; ++a) {
      const long double v = x[a];
      s.sum[a] = plus(s.sum[a], rounded(std::ldexp(v, FILM_FRACTION_BITS - exponent)));
      for (int b = 0; b < 3; ++b)
        s.product[a][b] = plus(s.product[a][b], rounded(std::ldexp(v * x[b], 2 * (FILM_MOMENT_FRACTION_BITS - exponent))));
    }
  }
  return s;
}

}  // namespace oclair::test
