#include <cfloat>
#include <limits>

#include "groups.h"

namespace oclair::selftest {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Where squares overflow or vanish, and all between; no denormals, which the device may flush.
std::vector<float> densities() {
  std::vector<float> list{0.0f, FLT_MIN, 1e-30f, 1e-23f, 1e-19f, 1.5f, 3.0f, 1.9e19f, 1e25f, 1e38f, FLT_MAX, infinity};
  Random random(9);
  while (list.size() < 250) list.push_back(static_cast<float>(random.log_between(1e-25, 1e25)));
  return list;
}

// The limits are taken as Veach's heuristic has them: 0 for a density of 0 even against another 0, 1/2 between infinities.
long double power_heuristic(float a, float b) {
  if (a == 0.0f) return 0.0L;
  if (std::isinf(a)) return std::isinf(b) ? 0.5L : 1.0L;
  if (std::isinf(b)) return 0.0L;
  const long double ratio = static_cast<long double>(b) / a;
  return 1.0L / (1.0L + ratio * ratio);
}

}  // namespace

// With r = b/a (u), r^2 (3 u), 1 + r^2 ((1 + 3/2) u since r <= 1) and the last division a weight errs by 8 u of itself at
// most, but may vanish where it is denormal; two that share the ratio sum to 1 within the rounding of the last division of
// each.
void check_mis(const Session& session, Group& group) {
  const std::vector<float> list = densities();
  std::vector<cl_float2> pairs;
  for (const float a : list)
    for (const float b : list) pairs.push_back({{a, b}});
  std::vector<float> weight(pairs.size());
  run(session, "mis_weights", pairs.size(), pairs, out(weight));
  double worst = 0, sum = 0;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i].s;
    const long double exact = power_heuristic(a, b);
    const double error = static_cast<double>(std::abs(weight[i] - exact));
    if (!(error <= FLT_MIN)) keep_worst(worst, error / (unit_roundoff * static_cast<double>(exact)));
    outside += !(weight[i] >= 0.0f && weight[i] <= 1.0f);
    if (a == 0.0f && b == 0.0f) continue;
    const double total = static_cast<double>(weight[i]) + weight[i % list.size() * list.size() + i / list.size()];
    keep_worst(sum, std::abs(total - 1.0));
  }
  group.measure("pairs", static_cast<double>(pairs.size()));
  group.bound("error in u of a weight", worst, 8 * slack(session));
  group.bound("in u of the sum of two", sum / unit_roundoff, 2 * slack(session));
  group.bound("outside [0, 1]", static_cast<double>(outside), 0);
}

}  // namespace oclair::selftest
