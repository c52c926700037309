#include <limits>

#include "film_oracle.h"
#include "groups.h"

namespace oclair::selftest {
namespace {

// Powers of two, so that no quotient or root is rounded, and none is denormal.
std::vector<cl_float2> pairs() {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float values[] = {0.0f, -0.0f, 1.0f, -1.0f, 4.0f, 0x1p-20f, -0x1p-20f, 0x1p100f, -0x1p100f, inf, -inf, nan, -nan};
  std::vector<cl_float2> list;
  for (const float x : values)
    for (const float y : values) list.push_back({{x, y}});
  return list;
}

uint comparisons(float x, float y) {
  return static_cast<uint>(x < y) | static_cast<uint>(x <= y) << 1 | static_cast<uint>(x == y) << 2 |
         static_cast<uint>(x != y) << 3 | static_cast<uint>(x > y) << 4 | static_cast<uint>(x >= y) << 5 |
         static_cast<uint>(!(x > y)) << 6 | static_cast<uint>(std::isnan(x)) << 7;
}

// The same number, or both NaN. fmin and fmax may take either of 0 and -0.
bool equal(float result, float exact) { return result == exact || (std::isnan(result) && std::isnan(exact)); }

// The same, zeros with their signs.
bool same(float result, float exact) { return equal(result, exact) && (exact != 0.0f || std::signbit(result) == std::signbit(exact)); }

// The same, or for a device that divides as OpenCL allows a finite number within 3 ulp.
bool same_quotient(float result, float exact, bool rounds_correctly) {
  if (rounds_correctly || !std::isfinite(exact) || exact == 0.0f) return same(result, exact);
  return std::abs(result - exact) <= 3.0 * ulp(exact);
}

}  // namespace

// NaN and infinities come out where IEEE 754 says, and are told by comparisons and by their bits: guards rest on that.
void check_exceptions(const Session& session, Group& group) {
  const std::vector<cl_float2> xy = pairs();
  std::vector<cl_uint> compared(xy.size()), accepted(xy.size());
  std::vector<cl_float8> result(xy.size());
  run(session, "compare", xy.size(), xy, out(compared));
  run(session, "arithmetic", xy.size(), xy, out(result), out(accepted));
  const bool correct = rounds_correctly(session.device);
  std::size_t comparisons_wrong = 0, results_wrong = 0, extremes_wrong = 0, guards_wrong = 0;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const float x = xy[i].s[0], y = xy[i].s[1];
    const auto& r = result[i].s;
    comparisons_wrong += compared[i] != comparisons(x, y);
    results_wrong += !same(r[0], x + y) || !same(r[1], x - y) || !same(r[2], x * y) || !same_quotient(r[3], x / y, correct) ||
                     !same_quotient(r[4], std::sqrt(x), correct);
    extremes_wrong += !equal(r[5], std::fmin(x, y)) || !equal(r[6], std::fmax(x, y));
    guards_wrong += (accepted[i] != 0) != acceptable(x, 0);
  }
  group.measure("pairs", static_cast<double>(xy.size()));
  group.bound("comparisons wrong", static_cast<double>(comparisons_wrong), 0);
  group.bound("results wrong", static_cast<double>(results_wrong), 0);
  group.bound("fmin or fmax wrong", static_cast<double>(extremes_wrong), 0);
  group.bound("guards by bits wrong", static_cast<double>(guards_wrong), 0);
}

}  // namespace oclair::selftest
