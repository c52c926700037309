#include <cstring>
#include <limits>

#include "groups.h"

namespace oclair::selftest {
namespace {

std::vector<float> coordinates() {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> list{0.0f, -0.0f, 1.0f, 0.5f, 1 - 0x1p-24f, 1 + 0x1p-23f, -1e-10f, 1e-10f, 1e-40f, -1e-40f, 1e8f,
      -1e8f, 0x1p24f, -0x1p24f, 0x1p31f, -0x1p31f, 1e30f, -1e30f, std::numeric_limits<float>::max(),
      -std::numeric_limits<float>::max(), inf, -inf, nan, -nan};
  Random random(10);
  while (list.size() < 4000)
    list.push_back(static_cast<float>(list.size() % 2 ? random.between(-4.0, 4.0) : random.signed_log_between(1e-12, 1e12)));
  return list;
}

std::size_t outside(const Session& session) {
  const std::vector<float> list = coordinates();
  std::vector<cl_uint> first(list.size()), second(list.size());
  std::vector<float> weight(list.size());
  std::size_t count = 0;
  for (const cl_uint n : {1u, 3u, 4096u, 65536u})
    for (const TextureWrap wrap : {WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP})
      for (const cl_uint nearest : {0u, 1u}) {
        run(session, "texel_spans", list.size(), list, n, static_cast<cl_uint>(wrap), nearest, out(first), out(second),
            out(weight));
        for (std::size_t i = 0; i < list.size(); ++i)
          count += first[i] >= n || second[i] >= n || !(weight[i] >= 0.0f && weight[i] <= 1.0f);
      }
  return count;
}

// Of binary16 by its definition (IEEE 754).
float half_value(uint bits) {
  const int exponent = bits >> 10 & 31u;
  const auto fraction = static_cast<float>(bits & 1023u);
  if (exponent == 31) return std::numeric_limits<float>::quiet_NaN();  // or infinity: not compared
  const float magnitude = exponent ? std::ldexp(1024.0f + fraction, exponent - 25) : std::ldexp(fraction, -24);
  return bits >> 15 ? -magnitude : magnitude;
}

// All texels of 16 bits, every other one first: a launch has fewer than 65536 work items.
template <class Value>
double texel_error(const Session& session, TexelFormat format, std::size_t values, std::size_t bytes, Value value) {
  Texture texture{};
  texture.channels = 1;
  texture.format = format;
  double worst = 0;
  for (const std::size_t from : {std::size_t{0}, std::size_t{1}}) {
    std::vector<cl_uchar> texels(values / 2 * bytes);
    for (std::size_t i = 0; i < values / 2; ++i) {
      const std::size_t bits = 2 * i + from;
      for (std::size_t byte = 0; byte < bytes; ++byte)
        texels[i * bytes + byte] = static_cast<cl_uchar>(bits >> (8 * byte));  // devices are little-endian
    }
    std::vector<float> result(values / 2);
    run(session, "texels", result.size(), std::vector<Texture>{texture}, texels, out(result));
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double exact = value(static_cast<uint>(2 * i + from));
      if (std::isnan(exact)) continue;
      keep_worst(worst, std::abs(result[i] - exact) / ulp(exact));
    }
  }
  return worst;
}

}  // namespace

// Whatever the coordinates, NaN and infinities included, the texels that they name exist. Halves are read exactly; integers
// are one division.
void check_textures(const Session& session, Group& group) {
  const double division = rounds_correctly(session.device) ? 0.5 : 2.5;
  group.bound("texels outside", static_cast<double>(outside(session)), 0);
  group.bound("ulp of 8 bits", texel_error(session, TEXEL_U8, 256, 1, [](uint bits) { return bits / 255.0; }), division);
  group.bound("of 16 bits", texel_error(session, TEXEL_U16, 65536, 2, [](uint bits) { return bits / 65535.0; }), division);
  group.bound("of halves",
              texel_error(session, TEXEL_HALF, 65536, 2, [](uint bits) { return static_cast<double>(half_value(bits)); }),
              0);
}

}  // namespace oclair::selftest
