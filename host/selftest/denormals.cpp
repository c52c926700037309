#include "groups.h"

namespace oclair::selftest {

// Denormal results and factors are kept, or taken for 0: the renderer lives with either, but not with anything else.
void check_denormals(const Session& session, Group& group) {
  Random random(3);
  std::vector<cl_float2> xy;
  while (xy.size() < many) {
    const double x = random.log_between(0x1p-63, 0x1p-40),
                 y = random.log_between(0x1p-84, 0x1p-64);  // product denormal or just above
    const double denormal = random.log_between(0x1p-148, 0x1p-127), large = random.log_between(1.0, 0x1p40);
    xy.push_back({{static_cast<float>(random.sign() * x), static_cast<float>(y)}});
    xy.push_back({{static_cast<float>(denormal), static_cast<float>(random.sign() * large)}});
  }
  std::vector<float> result(xy.size());
  run(session, "multiply", xy.size(), xy, out(result));
  std::size_t kept = 0, flushed = 0, wrong = 0;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const float x = xy[i].s[0], y = xy[i].s[1];
    const auto exact = static_cast<float>(static_cast<double>(x) * y);  // rounded once: the product is exact in double
    if (result[i] == exact && std::abs(exact) >= 0x1p-126f && std::abs(x) >= 0x1p-126f) continue;
    if (result[i] == exact && exact != 0.0f)
      ++kept;
    else if (result[i] == 0.0f && (std::abs(x) < 0x1p-126f || std::abs(static_cast<double>(x) * y) < 0x1p-126))
      ++flushed;
    else
      ++wrong;
  }
  const bool promised = (session.device.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_DENORM) != 0;
  group.say("denormals", flushed == 0 ? "kept" : kept == 0 ? "flushed" : "some kept, some flushed");
  group.measure("kept", static_cast<double>(kept));
  if (promised)
    group.bound("flushed although the device keeps them", static_cast<double>(flushed), 0);
  else
    group.measure("flushed", static_cast<double>(flushed));
  group.bound("wrong", static_cast<double>(wrong), 0);
}

}  // namespace oclair::selftest
