#include "kernel.h"

using namespace oclair::test;

// Extreme X20: u32 * 2^-32 rounds to 1.0f for 128 values of 2^32.
TEST(rng_test, unit_is_never_one) {
  std::vector<cl_uint> bits;
  for (std::size_t i = 0; i < 256; ++i) bits.push_back(0xffffffffu - static_cast<cl_uint>(i));
  std::vector<float> result(bits.size());
  run("rng_test.cl", "unit", bits.size(), bits, out(result));
  for (float u : result) EXPECT_EQ(u, 1.0f - 0x1p-24f);
}
