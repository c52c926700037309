// Textures on the device against long double arithmetic with integer indices (extremes X45, X46).
#include <array>
#include <bit>
#include <span>

#include "../host/material_placer.h"
#include "extremes.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr const char* file = "texture_test.cl";
using Real = long double;
constexpr Real u = 0x1p-24L;
constexpr TextureWrap wraps[] = {WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP};

// Texel of n that the integer i stands for, without bounds: written from what the modes mean.
std::int64_t wrapped(std::int64_t i, std::int64_t n, TextureWrap wrap) {
  if (wrap == WRAP_CLAMP) return std::clamp<std::int64_t>(i, 0, n - 1);
  if (wrap == WRAP_REPEAT) return ((i % n) + n) % n;
  const std::int64_t j = ((i % (2 * n)) + 2 * n) % (2 * n);
  return j < n ? j : 2 * n - 1 - j;
}

// An equivalent coordinate near 0: 2 is a period of all that repeats. Exact.
Real near_zero(Real x, TextureWrap wrap) { return wrap == WRAP_CLAMP ? std::clamp<Real>(x, -1, 2) : std::fmod(x, Real(2)); }

// Error of the kernel's position along an axis of n texels, in texels. Bringing x into [0, 1] rounds numbers below 2 twice
// and below 1 twice (2u + 2 u/2), the product with n and the difference with 1/2 numbers below n: n (3u + u + u).
Real position_error(Real n) { return 5 * u * n; }

struct Pixels {
  std::int64_t width, height;
  int channels;
  std::vector<Real> values;
  Real at(std::int64_t x, std::int64_t y, int c, TextureWrap wrap) const {
    return values[static_cast<std::size_t>((wrapped(y, height, wrap) * width + wrapped(x, width, wrap)) * channels + c)];
  }
};

Real bilinear(const Pixels& p, TextureWrap wrap, Real x, Real y, int c) {
  const Real px = near_zero(x, wrap) * static_cast<Real>(p.width) - 0.5L,
             py = near_zero(y, wrap) * static_cast<Real>(p.height) - 0.5L;
  const auto i = static_cast<std::int64_t>(std::floor(px)), j = static_cast<std::int64_t>(std::floor(py));
  const Real a = px - std::floor(px), b = py - std::floor(py);
  return (1 - b) * ((1 - a) * p.at(i, j, c, wrap) + a * p.at(i + 1, j, c, wrap)) +
         b * ((1 - a) * p.at(i, j + 1, c, wrap) + a * p.at(i + 1, j + 1, c, wrap));
}

std::vector<float> coordinates() {
  std::vector<float> list;
  for (const double x :
       {0.0,         1e-10, 1e-40,  0.5,          0.25,       1.0 / 3,    1 - 0x1p-24, 1.0, 1 + 0x1p-23, 1.5,  2.0,
        2 - 0x1p-23, 3.0,   4095.5, 0x1p23 - 0.5, 0x1p23 + 1, 0x1p24 - 1, 0x1p24,      1e8, 3e9,         1e20, 3.4e38})
    list.insert(list.end(), {static_cast<float>(x), static_cast<float>(-x)});
  Random random(1);
  for (std::size_t i = 0; i < count_or_small(20000, 40); ++i)
    list.push_back(static_cast<float>(i % 2 ? random.between(-3, 3) : random.signed_log_between(1e-12, 1e6)));
  return list;
}

Texture float_texture(uint width, uint height, uint channels, TextureWrap wrap, bool nearest) {
  Texture t{};
  t.kind = TEXTURE_BITMAP;
  t.format = TEXEL_FLOAT;
  t.channels = channels;
  t.width = width;
  t.height = height;
  t.wrap = wrap;
  t.nearest = nearest;
  t.to_u = {1, 0, 0};
  t.to_v = {0, 1, 0};
  return t;
}

template <class T>
ulong append(std::vector<std::byte>& texels, const std::vector<T>& values) {
  texels.resize((texels.size() + 3) / 4 * 4);
  const ulong offset = texels.size();
  const auto bytes = std::as_bytes(std::span(values));
  texels.insert(texels.end(), bytes.begin(), bytes.end());
  return offset;
}

struct Values {
  std::vector<cl_float4> value;
  std::vector<cl_float2> gradient;
};

Values evaluate(const std::vector<Texture>& textures, const std::vector<std::byte>& texels,
                const std::vector<cl_uint>& which, const std::vector<cl_float2>& uv) {
  Values v{std::vector<cl_float4>(uv.size()), std::vector<cl_float2>(uv.size())};
  run(file, "evaluate", uv.size(), textures, texels, srgb_table(), which, uv, out(v.value), out(v.gradient));
  return v;
}

// The texels of one row in the given format, each read by its centre.
std::vector<cl_float4> texels_read_back(Texture texture, const std::vector<std::byte>& texels) {
  std::vector<cl_float2> uv;
  for (uint i = 0; i < texture.width; ++i)
    uv.push_back({{(static_cast<float>(i) + 0.5f) / static_cast<float>(texture.width), 0.5f}});
  return evaluate({texture}, texels, std::vector<cl_uint>(uv.size(), 0), uv).value;
}

Real srgb_decoded_exactly(Real encoded) {
  return encoded <= 0.04045L ? encoded / 12.92L : std::pow((encoded + 0.055L) / 1.055L, 2.4L);
}

}  // namespace

TEST(texture_test, whatever_the_coordinate_the_texels_exist) {
  std::vector<float> list = coordinates();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  list.insert(list.end(), {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity});
  for (const cl_uint n : {1u, 3u, 4096u, 65536u})
    for (const TextureWrap wrap : wraps)
      for (const cl_uint nearest : {0u, 1u}) {
        std::vector<cl_uint> first(list.size()), second(list.size());
        std::vector<float> weight(list.size());
        run(file, "spans", list.size(), list, n, static_cast<cl_uint>(wrap), nearest, out(first), out(second), out(weight));
        for (std::size_t i = 0; i < list.size(); ++i) {
          ASSERT_LT(first[i], n) << list[i] << " wrap " << wrap;
          ASSERT_LT(second[i], n) << list[i] << " wrap " << wrap;
          ASSERT_TRUE(weight[i] >= 0.0f && weight[i] <= 1.0f) << list[i];
        }
      }
  record_law("X45");
}

// Where the position lies closer to the border of two texels than the kernel's error, either is right.
TEST(texture_test, nearest_takes_the_texel_that_holds_the_point) {
  const std::vector<float> list = coordinates();
  for (const cl_uint n : {1u, 3u, 4096u})
    for (const TextureWrap wrap : wraps) {
      std::vector<cl_uint> first(list.size()), second(list.size());
      std::vector<float> weight(list.size());
      run(file, "spans", list.size(), list, n, static_cast<cl_uint>(wrap), cl_uint{1}, out(first), out(second), out(weight));
      for (std::size_t i = 0; i < list.size(); ++i) {
        const Real position = near_zero(list[i], wrap) * n, error = position_error(n);
        const auto low = wrapped(static_cast<std::int64_t>(std::floor(position - error)), n, wrap),
                   high = wrapped(static_cast<std::int64_t>(std::floor(position + error)), n, wrap);
        ASSERT_TRUE(first[i] == low || first[i] == high)
            << list[i] << " of " << n << " wrap " << wrap << ": " << first[i] << ", not " << low;
      }
    }
  record_law("X45");
}

// Random images of 1 and 3 channels, all modes, random affine maps of the coordinates.
TEST(texture_test, bilinear_lookup_and_its_gradient_agree_with_long_double) {
  Random random(2);
  std::vector<Texture> textures;
  std::vector<Pixels> pixels;
  std::vector<std::byte> texels;
  for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 5u}, {3u, 2u}, {64u, 17u}})
    for (const cl_uint channels : {1u, 3u})
      for (const TextureWrap wrap : wraps) {
        Texture t = float_texture(width, height, channels, wrap, false);
        std::vector<float> values;
        for (cl_uint i = 0; i < width * height * channels; ++i) values.push_back(static_cast<float>(random.between(0, 2)));
        t.offset = append(texels, values);
        t.to_u = packed(random.in_cube(2));
        t.to_v = packed(random.in_cube(2));
        textures.push_back(t);
        pixels.push_back({width, height, static_cast<int>(channels), {values.begin(), values.end()}});
      }
  std::vector<cl_uint> which;
  std::vector<cl_float2> uv;
  for (std::size_t i = 0; i < textures.size() * count_or_small(4000, 2); ++i) {
    which.push_back(static_cast<cl_uint>(i % textures.size()));
    const double scale = i % 7 == 0 ? 100 : 2;
    const double a = random.between(-scale, scale), b = random.between(-scale, scale);
    uv.push_back({{static_cast<float>(a), static_cast<float>(b)}});
  }
  const Values result = evaluate(textures, texels, which, uv);
  std::size_t slopes = 0, backwards = 0;
  for (std::size_t i = 0; i < uv.size(); ++i) {
    const Texture& t = textures[which[i]];
    const Pixels& p = pixels[which[i]];
    const auto wrap = static_cast<TextureWrap>(t.wrap);
    const Real a = uv[i].s[0], b = uv[i].s[1];
    const auto lookup = [&](const packed_float3& row, Real s, Real r) { return row.x * s + row.y * r + row.z; };
    const auto magnitude = [&](const packed_float3& row) {
      return std::abs(row.x * a) + std::abs(row.y * b) + std::abs(row.z);
    };
    // The dot product rounds 5 times.
    const Real ex = position_error(t.width) + 5 * u * magnitude(t.to_u) * t.width;
    const Real ey = position_error(t.height) + 5 * u * magnitude(t.to_v) * t.height;
    // Values lie in [0, 2]: their slope is at most 2 per texel. Two mixes of two differences and products: 8 roundings of 2.
    const Real tolerance = 2 * (ex + ey) + 8 * u * 2;
    const Real x = lookup(t.to_u, a, b), y = lookup(t.to_v, a, b);
    Real number = 0;
    for (int c = 0; c < 3; ++c) {
      const Real expected = bilinear(p, wrap, x, y, p.channels == 1 ? 0 : c);
      const Real share[] = {0.2126L, 0.7152L, 0.0722L};
      number += share[c] * expected;
      ASSERT_NEAR(result.value[i].s[c], expected, tolerance) << i << " wrap " << wrap;
    }
    ASSERT_NEAR(result.value[i].s[3], number, tolerance + 12 * u) << i;
    // Within a cell the texture is a product of two linear functions: central differences are exact but for rounding.
    const auto within = [](Real position, Real reach) {
      return position - 0.5L - std::floor(position - 0.5L) > reach && std::ceil(position - 0.5L) - (position - 0.5L) > reach;
    };
    const Real h = 1e-4L;
    const Real rx = h * (std::abs(t.to_u.x) + std::abs(t.to_u.y)) * t.width + ex,
               ry = h * (std::abs(t.to_v.x) + std::abs(t.to_v.y)) * t.height + ey;
    const auto edge = [&](Real v) { return wrap != WRAP_REPEAT && std::abs(v - std::round(v)) < h * 4 + 1e-4L; };
    if (!within(x * t.width, rx) || !within(y * t.height, ry) || edge(x) || edge(y)) continue;
    const auto luminance = [&](Real s, Real r) {
      Real sum = 0;
      const Real share[] = {0.2126L, 0.7152L, 0.0722L};
      for (int c = 0; c < 3; ++c)
        sum += share[c] * bilinear(p, wrap, lookup(t.to_u, s, r), lookup(t.to_v, s, r), p.channels == 1 ? 0 : c);
      return sum;
    };
    const Real du = (luminance(a + h, b) - luminance(a - h, b)) / (2 * h),
               dv = (luminance(a, b + h) - luminance(a, b - h)) / (2 * h);
    // A slope along x is width times a difference of two values, itself mixed by the weight along y: its errors are those of
    // the luminances (8 roundings of 2) and of the weight times a change of slope of at most 4; all times the row's entries,
    // at most 2.
    const Real slope = 2 * (t.width * (4 * ey + 16 * u * 2) + t.height * (4 * ex + 16 * u * 2));
    ASSERT_NEAR(result.gradient[i].s[0], du, slope) << i << " wrap " << wrap;
    ASSERT_NEAR(result.gradient[i].s[1], dv, slope) << i << " wrap " << wrap;
    ++slopes;
    backwards += wrap == WRAP_MIRROR && (static_cast<long>(std::floor(x)) & 1);
  }
  if (!small_inputs()) {
    EXPECT_GT(slopes, uv.size() / 4);
    EXPECT_GT(backwards, slopes / 20);
  }
}

TEST(texture_test, nearest_has_no_gradient) {
  std::vector<std::byte> texels;
  Texture t = float_texture(2, 1, 1, WRAP_REPEAT, true);
  t.offset = append(texels, std::vector<float>{0.25f, 0.75f});
  const Values v = evaluate({t}, texels, {0, 0}, {{{0.3f, 0.5f}}, {{0.7f, 0.5f}}});
  EXPECT_EQ(v.value[0].s[0], 0.25f);
  EXPECT_EQ(v.value[1].s[0], 0.75f);
  for (const auto& g : v.gradient) EXPECT_TRUE(g.s[0] == 0.0f && g.s[1] == 0.0f);
}

// Rows run from top to bottom with v, columns from left to right with u; the second texture lies behind the first.
TEST(texture_test, the_first_row_lies_at_v_0) {
  std::vector<std::byte> texels;
  Texture t = float_texture(2, 3, 3, WRAP_CLAMP, true);
  append(texels, std::vector<float>{-1.0f});
  std::vector<float> values;
  for (int i = 0; i < 18; ++i) values.push_back(static_cast<float>(i));
  t.offset = append(texels, values);
  std::vector<cl_float2> uv;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 2; ++x) uv.push_back({{(static_cast<float>(x) + 0.5f) / 2, (static_cast<float>(y) + 0.5f) / 3}});
  const Values v = evaluate({t}, texels, std::vector<cl_uint>(6, 0), uv);
  for (int i = 0; i < 6; ++i)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(v.value[static_cast<std::size_t>(i)].s[c], static_cast<float>(3 * i + c));
}

// Measured in Mitsuba 3.9.1, variant scalar_rgb, 6 digits: three texels in a row.
TEST(texture_test, bitmaps_are_looked_up_as_in_mitsuba) {
  const std::vector<float> at = {-1.4f, -0.3f, 0.05f, 0.45f, 0.98f, 1.2f, 2.7f};
  const std::vector<double> expected[2][3] = {
      {{.75, .6, .205, .78, .268, .18, .6}, {.75, .42, .1, .78, .4, .45, .6}, {.1, .1, .1, .78, .4, .4, .4}},
      {{.9, .4, .1, .9, .4, .1, .4}, {.9, .1, .1, .9, .4, .4, .4}, {.1, .1, .1, .9, .4, .4, .4}}};
  std::vector<std::byte> texels;
  append(texels, std::vector<float>{0.1f, 0.9f, 0.4f});
  std::vector<cl_float2> uv;
  for (const float x : at) uv.push_back({{x, 0.3f}});
  for (const bool nearest : {false, true})
    for (const TextureWrap wrap : wraps) {
      const Values v = evaluate({float_texture(3, 1, 1, wrap, nearest)}, texels, std::vector<cl_uint>(uv.size(), 0), uv);
      for (std::size_t i = 0; i < at.size(); ++i)
        EXPECT_NEAR(v.value[i].s[0], expected[nearest][wrap][i], 1e-6) << at[i] << " wrap " << wrap;
    }
}

// A single quotient: 2.5 ulp by OpenCL's rules, and an ulp is at most 2 u.
TEST(texture_test, integers_are_shares_of_the_largest) {
  std::vector<std::uint8_t> bytes(256);
  std::vector<std::uint16_t> words(65536);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint16_t>(i);
  words.resize(count_or_small(words.size(), 64));
  std::vector<std::byte> texels;
  append(texels, std::vector<std::uint8_t>{7});  // so that the next does not begin at 0
  Texture t = float_texture(256, 1, 1, WRAP_CLAMP, true);
  t.format = TEXEL_U8;
  t.offset = append(texels, bytes);
  const auto eight = texels_read_back(t, texels);
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(eight[static_cast<std::size_t>(i)].s[0], i / 255.0L, 5 * u * i / 255) << i;
  t.format = TEXEL_U16;
  t.width = static_cast<uint>(words.size());
  t.offset = append(texels, words);
  const auto sixteen = texels_read_back(t, texels);
  for (std::size_t i = 0; i < words.size(); ++i)
    ASSERT_NEAR(sixteen[i].s[0], words[i] / 65535.0L, 5 * u * words[i] / 65535) << i;
}

// The table is rounded from double. Of 16 bits the kernel raises x to 2.4 with 16 ulp = 32 u, after two quotients of 5 u, a
// sum and two constants of u each, all of which count 2.4 times: 32 + 2.4 * 13 < 64 u.
TEST(texture_test, srgb_is_decoded_to_64_u) {
  const std::vector<float> table = srgb_table();
  ASSERT_EQ(table.size(), 256u);
  for (int i = 0; i < 256; ++i) {
    const Real exact = srgb_decoded_exactly(i / 255.0L);
    EXPECT_NEAR(table[static_cast<std::size_t>(i)], exact, exact * u * 1.0001L) << i;
  }
  std::vector<std::byte> texels;
  Texture t = float_texture(256, 1, 1, WRAP_CLAMP, true);
  t.srgb = 1;
  t.format = TEXEL_U8;
  std::vector<std::uint8_t> bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  t.offset = append(texels, bytes);
  const auto eight = texels_read_back(t, texels);
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(eight[i].s[0], table[i]) << i;
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < 65536; i += count_or_small(1, 1000)) words.push_back(static_cast<std::uint16_t>(i));
  t.format = TEXEL_U16;
  t.width = static_cast<uint>(words.size());
  t.offset = append(texels, words);
  const auto sixteen = texels_read_back(t, texels);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Real exact = srgb_decoded_exactly(words[i] / 65535.0L);
    ASSERT_NEAR(sixteen[i].s[0], exact, 64 * u * exact) << words[i];
  }
}

// Every finite half and some floats come back as they are, in all three channels.
TEST(texture_test, half_and_float_texels_are_exact) {
  std::vector<std::uint16_t> halves;
  for (std::uint32_t i = 0; i < 65536; i += static_cast<std::uint32_t>(count_or_small(1, 1001)))
    if ((i & 0x7c00) != 0x7c00) halves.push_back(static_cast<std::uint16_t>(i));
  while (halves.size() % 3) halves.pop_back();
  std::vector<std::byte> texels;
  Texture t = float_texture(static_cast<uint>(halves.size() / 3), 1, 3, WRAP_CLAMP, true);
  t.format = TEXEL_HALF;
  t.srgb = 1;  // means nothing for them
  t.offset = append(texels, halves);
  const auto read = texels_read_back(t, texels);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const int h = halves[i], exponent = h >> 10 & 31, mantissa = h & 1023;
    const double magnitude = exponent ? std::ldexp(1024 + mantissa, exponent - 25) : std::ldexp(mantissa, -24);
    ASSERT_EQ(read[i / 3].s[i % 3], static_cast<float>(h & 0x8000 ? -magnitude : magnitude)) << h;
  }
  const std::vector<float> floats = {0.0f, -1.5f, 1e-38f, 3e38f, 0x1.fffffep0f, 7.0f};
  t.format = TEXEL_FLOAT;
  t.width = 2;
  t.offset = append(texels, floats);
  const auto back = texels_read_back(t, texels);
  for (std::size_t i = 0; i < floats.size(); ++i) EXPECT_EQ(back[i / 3].s[i % 3], floats[i]);
  record_law("X50");
}

// Measured in Mitsuba 3.9.1: color0 where both coordinates lie in the same half of the unit square; 0.5 belongs to the lower
// one.
TEST(texture_test, checkerboard_has_its_first_colour_where_the_halves_agree) {
  Texture t{};
  t.kind = TEXTURE_CHECKERBOARD;
  t.channels = 3;
  t.color0 = {0.9f, 0.5f, 0.25f};
  t.color1 = {0.1f, 0.125f, 0.75f};
  t.to_u = {1, 0, 0};
  t.to_v = {0, 1, 0};
  const std::vector<std::pair<cl_float2, bool>> rows = {
      {{{0.25f, 0.25f}}, true},   {{{0.75f, 0.25f}}, false},  {{{0.5f, 0.25f}}, true},  {{{0.5f, 0.5f}}, true},
      {{{0.75f, 0.75f}}, true},   {{{0.25f, 0.75f}}, false},  {{{0, 0}}, true},         {{{1, 1}}, true},
      {{{-0.25f, 0.25f}}, false}, {{{-0.25f, -7.25f}}, true}, {{{1e10f, 0.75f}}, false}};
  std::vector<cl_float2> uv;
  for (const auto& row : rows) uv.push_back(row.first);
  const Values v = evaluate({t}, {}, std::vector<cl_uint>(uv.size(), 0), uv);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const packed_float3& c = rows[i].second ? t.color0 : t.color1;
    EXPECT_TRUE(v.value[i].s[0] == c.x && v.value[i].s[1] == c.y && v.value[i].s[2] == c.z)
        << uv[i].s[0] << " " << uv[i].s[1];
    EXPECT_NEAR(v.value[i].s[3], 0.2126L * c.x + 0.7152L * c.y + 0.0722L * c.z, 4 * u);
    EXPECT_TRUE(v.gradient[i].s[0] == 0.0f && v.gradient[i].s[1] == 0.0f);
  }
  t.to_u = {2, 0, 0.5f};  // to_uv acts before the squares are counted
  EXPECT_EQ(evaluate({t}, {}, {0}, {{{0.25f, 0.25f}}}).value[0].s[0], t.color0.x);
  EXPECT_EQ(evaluate({t}, {}, {0}, {{{0.0625f, 0.25f}}}).value[0].s[0], t.color1.x);
}

// b0 = 1 - b1 - b2 rounds twice, then three products and two sums: 5 roundings of the terms, 2 of 1 for b0, of values up
// to 3.
TEST(texture_test, attributes_are_interpolated_between_vertices_and_constant_on_faces) {
  Random random(3);
  const cl_uint first_triangle = 5, triangles = 40, vertices = 30;
  std::vector<packed_uint3> corners(first_triangle, packed_uint3{9999, 9999, 9999});
  for (cl_uint i = 0; i < triangles; ++i)
    corners.push_back({random.below(vertices), random.below(vertices), random.below(vertices)});
  std::vector<std::byte> texels;
  std::vector<Texture> textures;
  std::vector<std::vector<float>> values;
  for (const TextureKind kind : {TEXTURE_VERTEX_ATTRIBUTE, TEXTURE_FACE_ATTRIBUTE})
    for (const cl_uint channels : {1u, 3u}) {
      Texture t{};
      t.kind = kind;
      t.channels = channels;
      t.format = TEXEL_FLOAT;
      auto& v = values.emplace_back();
      for (cl_uint i = 0; i < channels * (kind == TEXTURE_VERTEX_ATTRIBUTE ? vertices : triangles); ++i)
        v.push_back(static_cast<float>(random.between(-3, 3)));
      t.offset = append(texels, v);
      textures.push_back(t);
    }
  const std::size_t count = count_or_small(20000, 64);
  std::vector<cl_uint> which(count), triangle(count);
  std::vector<cl_float2> b(count);
  for (std::size_t i = 0; i < count; ++i) {
    which[i] = static_cast<cl_uint>(i % 4);
    triangle[i] = first_triangle + random.below(triangles);
    const double b1 = random.unit(), b2 = random.between(0, 1 - b1);
    b[i] = {{static_cast<float>(b1), static_cast<float>(b2)}};
  }
  std::vector<cl_float4> result(count);
  run(file, "attributes", count, textures, texels, corners, first_triangle, which, triangle, b, out(result));
  for (std::size_t i = 0; i < count; ++i) {
    const Texture& t = textures[which[i]];
    const auto& v = values[which[i]];
    Real number = 0;
    for (cl_uint c = 0; c < 3; ++c) {
      const auto at = [&](cl_uint item) { return static_cast<Real>(v[item * t.channels + (t.channels == 3 ? c : 0)]); };
      const packed_uint3 p = corners[triangle[i]];
      const Real b1 = b[i].s[0], b2 = b[i].s[1];
      const bool face = t.kind == TEXTURE_FACE_ATTRIBUTE;
      const Real expected = face ? at(triangle[i] - first_triangle) : (1 - b1 - b2) * at(p.x) + b1 * at(p.y) + b2 * at(p.z);
      ASSERT_NEAR(result[i].s[c], expected, face ? 0 : (5 + 2) * u * 3) << i;
      number += (t.channels == 1 ? (c == 0) : (c == 0 ? 0.2126L : c == 1 ? 0.7152L : 0.0722L)) * expected;
    }
    ASSERT_NEAR(result[i].s[3], number, 12 * u * 3) << i;
  }
}

// In [0, 1]: repeated with one rounding of a number below 1, mirrored with one below 2 and one below 1, or cut off.
TEST(texture_test, coordinates_are_wrapped_to_u_and_a_half) {
  const std::vector<float> list = coordinates();
  for (const TextureWrap wrap : wraps) {
    std::vector<float> found(list.size());
    run(file, "wrapped", list.size(), list, static_cast<cl_uint>(wrap), out(found));
    for (std::size_t i = 0; i < list.size(); ++i) {
      ASSERT_TRUE(found[i] >= 0.0f && found[i] <= 1.0f) << list[i];
      const Real x = list[i], turns = x - std::floor(x), pair = x - 2 * std::floor(x / 2);
      const Real exact = wrap == WRAP_REPEAT   ? turns
                         : wrap == WRAP_MIRROR ? 1 - std::abs(pair - 1)
                                               : std::clamp<Real>(x, 0, 1);
      const Real off = std::abs(static_cast<Real>(found[i]) - exact);
      // A repeated coordinate that rounds to 1 is the same place as 0.
      ASSERT_LE(wrap == WRAP_REPEAT ? std::min(off, 1 - off) : off, 1.5L * u) << list[i] << " " << wrap;
    }
  }
}

TEST(texture_test, neighbours_beyond_an_edge_are_the_other_edge_or_the_edge_itself) {
  for (const TextureWrap wrap : wraps)
    for (cl_uint n = 1; n <= 5; ++n) {
      std::vector<cl_int> texel;
      for (cl_int i = -1; i <= static_cast<cl_int>(n); ++i) texel.push_back(i);
      std::vector<cl_uint> found(texel.size());
      run(file, "neighbours", texel.size(), texel, n, static_cast<cl_uint>(wrap), out(found));
      for (std::size_t i = 0; i < texel.size(); ++i)
        EXPECT_EQ(found[i], wrapped(texel[i], n, wrap)) << texel[i] << " of " << n;
    }
}

// Luminance: three constants, three products and two sums of positive numbers: 4 u. The curve: as above; at its corner
// either branch.
TEST(texture_test, luminance_and_the_curve_of_srgb_are_those_of_their_standards) {
  Random random(2);
  std::vector<cl_float4> colour;
  for (std::size_t i = 0; i < count_or_small(10000, 40); ++i)
    colour.push_back({{random.unit24(), random.unit24(), random.unit24(), random.unit24()}});
  for (int c = 0; c < 4; ++c)
    colour.push_back({{c == 0 ? 1.0f : 0.0f, c == 1 ? 1.0f : 0.0f, c == 2 ? 1.0f : 0.0f, c == 3 ? 1.0f : 0.0f}});
  std::vector<float> gray(colour.size()), linear(colour.size());
  run(file, "curves", colour.size(), colour, out(gray), out(linear));
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const auto& c = colour[i].s;
    const Real exact = 0.2126L * c[0] + 0.7152L * c[1] + 0.0722L * c[2];
    ASSERT_NEAR(gray[i], exact, 4 * u * exact);
    if (std::abs(c[3] - 0.04045f) < 1e-6f) continue;
    ASSERT_NEAR(linear[i], srgb_decoded_exactly(c[3]), 64 * u * srgb_decoded_exactly(c[3]));
  }
}
