// Integers of several 64-bit limbs, least significant first: the film's sums on the host.
#pragma once

#include <cstddef>

#include "../cl/types.h"

namespace oclair {

// sum += addend, modulo 2^(64 LIMBS).
template <std::size_t LIMBS>
void add(ulong (&sum)[LIMBS], const ulong (&addend)[LIMBS]) {
  ulong carry = 0;
  for (std::size_t i = 0; i < LIMBS; ++i) {
    const ulong with_carry = addend[i] + carry;  // 0 with a carry out where it wraps: the sum below cannot wrap as well
    carry = with_carry < carry;
    sum[i] += with_carry;
    carry += sum[i] < with_carry;
  }
}

}  // namespace oclair
