#include <functional>

#include "diffuse_oracle.h"
#include "extremes.h"
#include "quadrature.h"
#include "scatter_cases.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Pairs {
  std::vector<cl_float4> wo, wi;
};

std::vector<cl_float4> evaluate(const char* kernel, const Material& material, const Pairs& pairs) {
  std::vector<cl_float4> result(pairs.wi.size());
  run("oren_nayar_test.cl", kernel, result.size(), std::vector(result.size(), material), pairs.wo, pairs.wi, out(result));
  return result;
}

Material white(MaterialKind kind, double sigma, float reflectance = 1.0f) {
  return rough(kind, static_cast<float>(sigma), {reflectance, reflectance, reflectance});
}

cl_float4 direction(double cosine, double phi) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {{static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)), static_cast<float>(cosine), 0}};
}

// Each of 10^-7 ... 1 by each, in the same plane, across and opposite; near the pole; random ones.
Pairs pairs() {
  std::vector<double> cosines{1.0, 1 - 0x1p-24, 1 - 1e-6, 0.5, 0.999};
  for (int k = 1; k <= 7; ++k) cosines.push_back(std::pow(10.0, -k));
  Pairs list;
  const auto add = [&](const cl_float4& wo, const cl_float4& wi) { list.wo.push_back(wo), list.wi.push_back(wi); };
  for (double o : cosines)
    for (double i : cosines)
      for (double phi : {0.0, 1.0, pi / 2, 3.0, pi}) add(direction(o, 0.3), direction(i, 0.3 + phi));
  for (double i : cosines) add({{0, 0, 1, 0}}, direction(i, 2)), add(direction(i, 2), {{0, 0, 1, 0}});
  for (float tiny : {1e-7f, 1e-20f, 1e-30f, 1e-44f}) add({{tiny, 0, 1, 0}}, {{0, tiny, 1, 0}}), add({{0, -tiny, 1, 0}}, {{0, 0.6f, 0.8f, 0}});
  const std::size_t count = count_or_small(60000, 100);
  const std::vector<cl_float4> a = upper_directions(200, count), b = upper_directions(201, count + 17);
  for (std::size_t i = 0; i < count; ++i) add(a[i], b[i + 17]);
  return list;
}

// The largest |f cos - expected|; NaN counts as infinite.
double largest_error(const Pairs& pairs, const std::vector<cl_float4>& result, const std::function<Exact(const Angles&)>& factor) {
  double largest = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Angles angles = angles_of(pairs.wi[i], pairs.wo[i]);
    const double error = static_cast<double>(std::abs(result[i].s[0] - factor(angles) * std::cos(angles.in) / exact_pi));
    if (!(error <= largest)) largest = std::isnan(error) ? 1e300 : error;
  }
  return largest;
}

// The integrand has kinks where the two polar angles are equal and where the cosine of the azimuth changes its sign, and is even in
// the azimuth. In the polar angle it is smooth between them, tangent and all.
constexpr int polar_nodes = 20, azimuth_nodes = 12;

double directional_albedo(const char* kernel, const Material& material, double theta) {
  Pairs list;
  std::vector<double> weights;
  const cl_float4 wo = direction(std::cos(theta), 0);
  for (const auto& [low, high] : {std::pair{0.0, theta}, std::pair{theta, pi / 2}})
    if (high > low)
      for (const Node& t : gauss_legendre(polar_nodes, low, high))
        for (double start : {0.0, pi / 2})
          for (const Node& phi : gauss_legendre(azimuth_nodes, start, start + pi / 2)) {
            list.wo.push_back(wo);
            list.wi.push_back({{static_cast<float>(std::sin(t.x) * std::cos(phi.x)), static_cast<float>(std::sin(t.x) * std::sin(phi.x)),
                                static_cast<float>(std::cos(t.x)), 0}});
            weights.push_back(2 * t.weight * phi.weight * std::sin(t.x));
          }
  const std::vector<cl_float4> value = evaluate(kernel, material, list);
  double albedo = 0;
  for (std::size_t i = 0; i < value.size(); ++i) albedo += weights[i] * value[i].s[0];
  return albedo;
}

double hemispherical_albedo(const char* kernel, const Material& material) {
  double albedo = 0;
  for (const Node& t : gauss_legendre(16, 0, pi / 2))
    albedo += t.weight * std::sin(2 * t.x) * directional_albedo(kernel, material, t.x);
  return albedo;
}

constexpr double degree = pi / 180;
const std::vector<double> sigmas{0.1, 0.25, 0.3, 0.5, pi / 4, 1.0};

struct AlbedoRow {
  double degrees;
  std::vector<double> albedo;  // for each of the sigmas
};

void expect_albedos(const char* kernel, MaterialKind kind, const std::vector<AlbedoRow>& rows) {
  for (const AlbedoRow& row : rows)
    for (std::size_t i = 0; i < sigmas.size(); ++i) {
      EXPECT_NEAR(directional_albedo(kernel, white(kind, sigmas[i]), row.degrees * degree), row.albedo[i], 1e-5)
          << row.degrees << " degrees, sigma " << sigmas[i];
      if (small_inputs()) return;
    }
}

}  // namespace

// f cos is at most 0.7. Its terms are at most 1/pi (C1), .45/pi (C2, as tan beta cos_i <= 1) and .25/pi (C3, as the tangent of half
// the sum times cos_i is at most 2). The cosine of the azimuth errs by 9u, arc tangents by 6 ulp, each term by some 8 roundings,
// the arguments by 2u from unit length: (8 + 1.3 + 2.6 + .7 + 2) u, of which 1.3 u are met.
constexpr double tolerance = 15 * unit_roundoff;

TEST(oren_nayar_test, full_model_is_the_formula_of_the_paper) {
  const Pairs list = pairs();
  double worst = 0;
  for (double sigma : {0.0, 1e-3, 0.1, 0.3, 0.5, 1.0, 1.5})
    for (float rho : {1.0f, 0.3f}) {
      const Exact s = static_cast<float>(sigma), r = rho;
      const double error = largest_error(list, evaluate("full", white(MATERIAL_OREN_NAYAR, sigma, rho), list),
                                         [&](const Angles& a) { return exact_oren_nayar(a, s, r); });
      EXPECT_LE(error, tolerance) << sigma << " " << rho;
      worst = std::max(worst, error);
    }
  record_extreme("X39", worst / unit_roundoff, 15);
}

TEST(oren_nayar_test, qualitative_model_is_the_formula_of_the_paper) {
  const Pairs list = pairs();
  double worst = 0;
  for (double sigma : {0.0, 1e-3, 0.1, 0.3, 0.5, 1.0, 1.5}) {
    const Exact s = static_cast<float>(sigma);
    const double error = largest_error(list, evaluate("fast", white(MATERIAL_OREN_NAYAR_FAST, sigma), list),
                                       [&](const Angles& a) { return exact_oren_nayar_fast(a, s); });
    EXPECT_LE(error, tolerance) << sigma;
    worst = std::max(worst, error);
  }
  record_extreme("X39", worst / unit_roundoff, 15);
}

TEST(oren_nayar_test, channels_are_independent_and_the_interreflection_is_quadratic_in_each) {
  const Pairs list = pairs();
  const std::vector<cl_float4> full = evaluate("full", rough(MATERIAL_OREN_NAYAR, 0.5f), list);
  const std::vector<cl_float4> fast = evaluate("fast", rough(MATERIAL_OREN_NAYAR_FAST, 0.5f), list);
  const float rho[] = {0.8f, 0.5f, 0.25f};
  for (std::size_t i = 0; i < list.wi.size(); ++i) {
    const Angles a = angles_of(list.wi[i], list.wo[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(full[i].s[k], static_cast<double>(exact_oren_nayar(a, 0.5L, rho[k]) * std::cos(a.in) / exact_pi), tolerance);
      ASSERT_NEAR(fast[i].s[k], static_cast<double>(rho[k] * exact_oren_nayar_fast(a, 0.5L) * std::cos(a.in) / exact_pi), tolerance);
    }
  }
}

// sigma = 0 leaves C1 = A = 1 and nothing else, in every direction.
TEST(oren_nayar_test, without_roughness_both_are_lambert_exactly) {
  const Pairs list = pairs();
  for (const cl_float4& value : evaluate("full", white(MATERIAL_OREN_NAYAR, 0, 0.5f), list)) ASSERT_EQ(value.s[3], 0.5f);
  for (const cl_float4& value : evaluate("fast", white(MATERIAL_OREN_NAYAR_FAST, 0, 0.5f), list)) ASSERT_EQ(value.s[3], 0.5f);
}

// The paper's fit is, at opposite grazing directions.
TEST(oren_nayar_test, no_direction_is_negative) {
  for (const cl_float4& value : evaluate("full", white(MATERIAL_OREN_NAYAR, 1.5, 0.1f), pairs())) ASSERT_GE(value.s[3], 0.0f);
}

// Every step is symmetrical.
TEST(oren_nayar_test, both_are_reciprocal_bit_for_bit) {
  const Pairs list = pairs(), swapped{list.wi, list.wo};
  for (const auto& [kernel, kind] : {std::pair{"full", MATERIAL_OREN_NAYAR}, std::pair{"fast", MATERIAL_OREN_NAYAR_FAST}}) {
    const std::vector<cl_float4> there = evaluate(kernel, white(kind, 0.5), list), back = evaluate(kernel, white(kind, 0.5), swapped);
    for (std::size_t i = 0; i < there.size(); ++i) ASSERT_EQ(there[i].s[3], back[i].s[3]) << kernel << " " << i;
  }
}

TEST(oren_nayar_test, nothing_is_scattered_to_the_other_side) {
  Pairs list = pairs();
  for (cl_float4& wi : list.wi) wi.s[2] = -wi.s[2];
  for (const auto& [kernel, kind] : {std::pair{"full", MATERIAL_OREN_NAYAR}, std::pair{"fast", MATERIAL_OREN_NAYAR_FAST}})
    for (const cl_float4& value : evaluate(kernel, white(kind, 1.0), list))
      for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(value.s[k], 0.0f) << kernel;
}

// Tables computed with adaptive quadrature in double from the papers' formulas; the closed form for the qualitative model.
TEST(oren_nayar_test, directional_albedo_of_the_qualitative_model_is_its_closed_form) {
  const std::vector<AlbedoRow> rows{{0, {.98529412, .92038217, .89285714, .78448276, .67426198, .62406015}},
                                    {30, {.99076702, .94281210, .92022166, .82472469, .72202261, .67427027}},
                                    {45, {.99435790, .95752881, .93817605, .85112822, .75335930, .70721412}},
                                    {60, {.99870993, .97536499, .95993619, .88312842, .79133834, .74714098}},
                                    {75, {1.0034666, .99485951, .98371950, .91810387, .83284852, .79078007}},
                                    {85, {1.0064656, 1.0071506, .99871467, .94015559, .85902032, .81829414}}};
  for (const AlbedoRow& row : rows)
    for (std::size_t i = 0; i < sigmas.size(); ++i)
      EXPECT_NEAR(static_cast<double>(exact_oren_nayar_fast_albedo(row.degrees * degree, sigmas[i])), row.albedo[i], 1e-7);
  expect_albedos("fast", MATERIAL_OREN_NAYAR_FAST, rows);
}

TEST(oren_nayar_test, directional_albedo_of_the_full_model_meets_its_table) {
  expect_albedos("full", MATERIAL_OREN_NAYAR,
                 {{0, {.99743697, .97557697, .96240260, .89632486, .81467104, .77450263}},
                  {30, {.99784431, .97724640, .96443930, .89932001, .81822579, .77823969}},
                  {45, {.99903681, .98213367, .97040177, .90808835, .82863239, .78918001}},
                  {60, {1.0016097, .99267811, .98326598, .92700631, .85108493, .81278407}},
                  {75, {1.0060477, 1.0108670, 1.0054564, .95963933, .88981502, .85350050}},
                  {85, {1.0107331, 1.0300692, 1.0288831, .99409038, .93070281, .89648529}},
                  {89, {1.0138009, 1.0426423, 1.0442222, 1.0166479, .95747488, .92463041}}});
  if (small_inputs()) return;
  const std::vector<std::array<double, 4>> half{{0, .46381494, .42020191, .34964069}, {60, .47424663, .43554263, .36878142},
                                                {85, .49705521, .46908466, .41063202}};
  for (const auto& [degrees, a, b, c] : half)
    for (const auto& [sigma, albedo] : {std::pair{0.3, a}, std::pair{0.5, b}, std::pair{1.0, c}})
      EXPECT_NEAR(directional_albedo("full", white(MATERIAL_OREN_NAYAR, sigma, 0.5f), degrees * degree), albedo, 1e-5) << degrees;
}

TEST(oren_nayar_test, hemispherical_albedos_meet_their_tables) {
  const double fast[] = {.9949222849, .9598418676, .9409979793, .8552781063, .7582845456, .7123919603};
  const double full[] = {1.0002134, .98695578, .97628474, .91673978, .83890023, .79997445};
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    if (small_inputs()) return;
    EXPECT_NEAR(hemispherical_albedo("fast", white(MATERIAL_OREN_NAYAR_FAST, sigmas[i])), fast[i], 1e-5) << sigmas[i];
    EXPECT_NEAR(hemispherical_albedo("full", white(MATERIAL_OREN_NAYAR, sigmas[i])), full[i], 1e-5) << sigmas[i];
  }
}
