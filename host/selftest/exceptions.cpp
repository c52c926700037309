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

// The same, or both NaN; of what is finite 3 ulp, for devices that divide as OpenCL allows.
bool agree(float result, float exact) {
  if (std::isnan(exact)) return std::isnan(result);
  if (std::isinf(exact) || exact == 0.0f) return result == exact;
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
  std::size_t comparisons_wrong = 0, results_wrong = 0, extremes_wrong = 0, guards_wrong = 0;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const float x = xy[i].s[0], y = xy[i].s[1];
    const auto& r = result[i].s;
    comparisons_wrong += compared[i] != comparisons(x, y);
    results_wrong += !agree(r[0], x + y) || !agree(r[1], x - y) || !agree(r[2], x * y) || !agree(r[3], x / y) ||
                     !agree(r[4], std::sqrt(x));
    extremes_wrong += !agree(r[5], std::fmin(x, y)) || !agree(r[6], std::fmax(x, y));
    guards_wrong += (accepted[i] != 0) != acceptable(x, 0);
  }
  group.measure("pairs", static_cast<double>(xy.size()));
  group.bound("comparisons wrong", static_cast<double>(comparisons_wrong), 0);
  group.bound("results wrong", static_cast<double>(results_wrong), 0);
  group.bound("fmin or fmax wrong", static_cast<double>(extremes_wrong), 0);
  group.bound("guards by bits wrong", static_cast<double>(guards_wrong), 0);
}

}  // namespace oclair::selftest
