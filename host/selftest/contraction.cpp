#include "groups.h"

namespace oclair::selftest {
namespace {

// Every other pair of products all but cancels.
std::vector<cl_float4> factors() {
  Random random(1);
  std::vector<cl_float4> list(many);
  for (std::size_t i = 0; i < list.size(); ++i) {
    cl_float4& v = list[i];
    for (float& component : v.s) component = static_cast<float>(random.signed_log_between(1e-3, 1e3));
    if (i % 2) v.s[3] = static_cast<float>(static_cast<double>(v.s[0]) * v.s[1] / v.s[2]);
  }
  return list;
}

// Exact in double, then rounded: no compiler may fuse it.
float product(float x, float y) { return static_cast<float>(static_cast<double>(x) * y); }

}  // namespace

// In every expression of the kernels products are rounded before they are added; only fma() is fused, and it is. Kahan's
// difference of products, which rests on both, errs by at most 1.5 ulp (Jeannerod, Louvet, Muller 2013).
void check_contraction(const Session& session, Group& group) {
  const std::vector<cl_float4> xyzw = factors();
  std::vector<cl_float4> result(xyzw.size());
  run(session, "products", xyzw.size(), xyzw, out(result));
  std::size_t fused = 0, not_fused = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < xyzw.size(); ++i) {
    const auto [x, y, z, w] = xyzw[i].s;
    fused += result[i].s[0] != product(x, y) - product(z, w) || result[i].s[1] != product(x, y) + z;
    not_fused += result[i].s[2] != std::fma(x, y, z);
    const long double exact = static_cast<long double>(static_cast<double>(x) * y) - static_cast<double>(z) * w;
    const long double error = std::abs(result[i].s[3] - exact);
    keep_worst(worst, static_cast<double>(error) / ulp(static_cast<double>(exact)));
  }
  group.measure("expressions", static_cast<double>(xyzw.size()));
  group.bound("fused", static_cast<double>(fused), 0);
  group.bound("fma() not fused", static_cast<double>(not_fused), 0);
  group.bound("ulp of a b - c d by Kahan", worst, 1.5);
}

}  // namespace oclair::selftest
