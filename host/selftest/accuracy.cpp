#include "groups.h"

namespace oclair::selftest {
namespace {

// The largest error so far, in ulp of the exact result.
struct Worst {
  double ulps = 0.0;
  void take(float result, long double exact) {
    keep_worst(ulps, static_cast<double>(std::abs(result - exact)) / ulp(static_cast<double>(exact)));
  }
};

}  // namespace

// The bounds are those of OpenCL 1.2, 7.4, full profile; half an ulp where the device has promised it. No result is
// denormal.
void check_accuracy(const Session& session, Group& group) {
  const bool correct = rounds_correctly(session.device);
  Random random(2);
  std::vector<cl_float2> xy(many);
  for (cl_float2& v : xy) {
    v.s[0] = static_cast<float>(random.log_between(1e-18, 1e18));
    v.s[1] = static_cast<float>(random.log_between(1e-18, 1e18));
  }
  std::vector<cl_float4> quotients(xy.size());
  run(session, "quotients", xy.size(), xy, out(quotients));
  Worst division, root, reciprocal_root;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const long double x = xy[i].s[0], y = xy[i].s[1];
    division.take(quotients[i].s[0], x / y);
    division.take(quotients[i].s[1], 1.0L / y);
    root.take(quotients[i].s[2], std::sqrt(x));
    reciprocal_root.take(quotients[i].s[3], 1.0L / std::sqrt(x));
  }
  group.bound("ulp of /", division.ulps, correct ? 0.5 : 2.5);
  group.bound("sqrt", root.ulps, correct ? 0.5 : 3.0);
  group.bound("rsqrt", reciprocal_root.ulps, 2.0);

  std::vector<cl_float4> xyzw(many), functions(many);
  std::vector<float> powers(many);
  for (std::size_t i = 0; i < many; ++i) {
    const double z = i % 2 ? random.log_between(1e-3, 1e3) : random.between(0.9, 1.1);
    xyzw[i] = {{static_cast<float>(i % 2 ? random.between(-100.0, 100.0) : random.signed_log_between(1e-6, 8.0)),
                static_cast<float>(random.between(-87.0, 88.0)), static_cast<float>(z),
                static_cast<float>(random.between(-10.0, 10.0))}};
  }
  run(session, "functions", many, xyzw, out(functions), out(powers));
  Worst sine, cosine, exponential, logarithm, power;
  for (std::size_t i = 0; i < many; ++i) {
    const auto [x, y, z, w] = xyzw[i].s;
    sine.take(functions[i].s[0], std::sin(static_cast<long double>(x)));
    cosine.take(functions[i].s[1], std::cos(static_cast<long double>(x)));
    exponential.take(functions[i].s[2], std::exp(static_cast<long double>(y)));
    logarithm.take(functions[i].s[3], std::log(static_cast<long double>(z)));
    power.take(powers[i], std::pow(static_cast<long double>(z), static_cast<long double>(w)));
  }
  group.bound("sin", sine.ulps, 4.0);
  group.bound("cos", cosine.ulps, 4.0);
  group.bound("exp", exponential.ulps, 3.0);
  group.bound("log", logarithm.ulps, 3.0);
  group.bound("powr", power.ulps, 16.0);
}

}  // namespace oclair::selftest
