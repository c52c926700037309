#include <limits>

#include "film_oracle.h"
#include "groups.h"

namespace oclair::selftest {
namespace {

std::vector<ulong> words(Random& random) {
  std::vector<ulong> list{0, ~ulong{0}, 0x0123456789abcdefu};
  for (int bit = 0; bit < 64; ++bit) list.push_back(ulong{1} << bit), list.push_back(~(ulong{1} << bit));
  while (list.size() < 240) list.push_back(random.engine());
  return list;
}

std::size_t wrong_integers(const Session& session, Random& random) {
  const std::vector<ulong> list = words(random);
  std::vector<cl_ulong2> xy;
  for (const ulong x : list)
    for (const ulong y : list) xy.push_back({{x, y}});
  std::vector<cl_ulong8> result(xy.size());
  run(session, "integers", xy.size(), xy, out(result));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const ulong x = xy[i].s[0], y = xy[i].s[1], low = x & 0xffffffffu, low_product = low * (y & 0xffffffffu);
    const Uint128 product = static_cast<Uint128>(x) * y, sum = static_cast<Uint128>(x) + y + (x & 1);
    const ulong expected[8] = {static_cast<ulong>(product), static_cast<ulong>(product >> 64), static_cast<ulong>(sum),
                               static_cast<ulong>(sum >> 64), x << (y & 63), x >> (y & 63), low_product & 0xffffffffu,
                               low_product >> 32};
    wrong += !std::equal(expected, expected + 8, result[i].s);
  }
  return wrong;
}

std::size_t wrong_conversions(const Session& session, Random& random) {
  std::vector<float> x{0.0f, -0.0f, 0.5f, -0.5f, 1.5f, 2.5f, -2.5f, 0x1p31f, -0x1p31f, 0x1.fffffep30f, 1e30f, -1e30f,
      std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  while (x.size() < many) x.push_back(static_cast<float>(random.signed_log_between(1e-3, 1e12)));
  std::vector<cl_uint> n(x.size());
  for (cl_uint& bits : n) bits = static_cast<cl_uint>(random.engine());
  std::vector<cl_int> saturated(x.size());
  std::vector<cl_float4> result(x.size());
  run(session, "conversions", x.size(), x, n, out(saturated), out(result));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double toward_zero = std::clamp(std::trunc(static_cast<double>(x[i])), -0x1p31, 0x1p31 - 1.0);
    const float floats[4] = {std::floor(x[i]), std::nearbyint(x[i]), static_cast<float>(n[i] >> 8),
                             static_cast<float>(static_cast<cl_int>(n[i]))};
    wrong += saturated[i] != toward_zero || !std::equal(floats, floats + 4, result[i].s);
  }
  return wrong;
}

}  // namespace

// Integers of 64 bits, whose products and carries the film's sums and the random numbers are made of, and the ways between
// integers and floats.
void check_integers(const Session& session, Group& group) {
  Random random(4);
  group.bound("wrong of 57600 pairs of 64-bit integers", static_cast<double>(wrong_integers(session, random)), 0);
  group.bound("conversions wrong", static_cast<double>(wrong_conversions(session, random)), 0);
}

}  // namespace oclair::selftest
