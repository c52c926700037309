#include "extremes.h"
#include "fresnel_oracle.h"
#include "scatter_cases.h"

using namespace oclair::test;

namespace {

const std::vector<float> glasses{1.0001f, 1.33f, 1.5f, 2.42f, 1 / 1.33f, 1 / 2.42f};
constexpr float last = 1 - 0x1p-24f;  // the largest random number

struct Case {
  cl_float4 wo;
  float eta;
  cl_uint front;
  float u;
  Exact relative() const { return front ? Exact(eta) : 1 / Exact(eta); }
  Exact reflectance() const { return exact_reflectance(wo.s[2], relative()); }
  // Within 1e-4 of the critical cosine dF/dcos has no bound: fresnel_test judges it there.
  bool critical() const { return relative() < 1 && std::abs(wo.s[2] - critical_cosine(relative())) < 1e-4L; }
};

Scatters sample(const std::vector<Case>& cases, oclair::packed_float3 reflectance = {1, 1, 1},
                oclair::packed_float3 transmittance = {1, 1, 1}) {
  std::vector<oclair::Material> materials;
  std::vector<cl_float4> wo;
  std::vector<cl_uint> front;
  std::vector<float> u;
  for (const Case& c : cases) {
    materials.push_back(dielectric(c.eta, reflectance, transmittance));
    wo.push_back(c.wo), front.push_back(c.front), u.push_back(c.u);
  }
  Scatters result(cases.size());
  run("dielectric_test.cl", "sample", cases.size(), materials, wo, front, u, out(result.direction_pdf), out(result.weight_eta));
  return result;
}

std::vector<Case> every_case(std::uint64_t seed, float u) {
  std::vector<Case> cases;
  for (float eta : glasses)
    for (cl_uint front : {1u, 0u})
      for (const cl_float4& wo : upper_directions(seed, count_or_small(2000, 40))) cases.push_back({wo, eta, front, u});
  return cases;
}

bool is_reflected(const cl_float4& wi) { return wi.s[2] >= 0; }

}  // namespace

// A random number below the reflectance reflects, one above refracts: tried 2e-5 on either side (the kernel's reflectance errs by
// 1e-6 and, up to 1e-4 from the critical cosine, by 6e-6; see fresnel_test).
TEST(dielectric_test, reflects_when_the_random_number_is_below_the_reflectance) {
  std::vector<Case> cases;
  std::vector<bool> reflected;
  for (const Case& c : every_case(80, 0)) {
    const float f = static_cast<float>(c.reflectance());
    if (c.critical()) continue;
    for (float offset : {-2e-5f, 2e-5f})
      if (f + offset >= 0 && f + offset < 1) {
        cases.push_back({c.wo, c.eta, c.front, f + offset});
        reflected.push_back(offset < 0);
      }
  }
  const Scatters samples = sample(cases);
  for (std::size_t i = 0; i < cases.size(); ++i)
    ASSERT_EQ(is_reflected(samples.direction_pdf[i]), reflected[i])
        << cases[i].eta << " " << cases[i].front << " " << cases[i].wo.s[2];
}

TEST(dielectric_test, reflected_light_keeps_its_angle_and_takes_the_reflectance_colour) {
  const std::vector<Case> cases = every_case(81, 0);
  const Scatters samples = sample(cases, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const cl_float4 &wi = samples.direction_pdf[i], &wo = cases[i].wo, &weight = samples.weight_eta[i];
    ASSERT_TRUE(wi.s[0] == -wo.s[0] && wi.s[1] == -wo.s[1] && wi.s[2] == wo.s[2] && wi.s[3] == 0);
    ASSERT_TRUE(weight.s[0] == 0.9f && weight.s[1] == 0.8f && weight.s[2] == 0.7f && weight.s[3] == 1);
  }
}

// Radiance is divided by eta^2 (Veach 1997, sec. 5.2). Rounding of eta (u, twice over) and two operations: 5u.
TEST(dielectric_test, transmitted_light_takes_the_transmittance_colour_over_eta_squared) {
  const std::vector<Case> cases = every_case(82, last);
  const Scatters samples = sample(cases, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f});
  std::size_t transmitted = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const cl_float4 &wi = samples.direction_pdf[i], &weight = samples.weight_eta[i];
    if (is_reflected(wi)) continue;
    ++transmitted;
    const double eta = static_cast<double>(cases[i].relative());
    ASSERT_NEAR(weight.s[3], eta, 1.01 * unit_roundoff * eta);
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = std::array{0.3f, 0.2f, 0.1f}[k] / (eta * eta);
      ASSERT_NEAR(weight.s[k], expected, 5 * unit_roundoff * expected);
    }
    ASSERT_EQ(wi.s[3], 0.0f);
  }
  EXPECT_GT(transmitted, cases.size() / 2);
}

TEST(dielectric_test, reflects_everything_beyond_the_critical_angle) {
  std::vector<Case> cases;
  for (const Case& c : every_case(83, last))
    if (c.relative() < 1 && c.wo.s[2] < critical_cosine(c.relative()) * (1 - 8 * unit_roundoff))
      for (float u : {0.0f, 0.5f, last}) cases.push_back({c.wo, c.eta, c.front, u});
  ASSERT_GT(cases.size(), 100u);
  const Scatters samples = sample(cases);
  for (const cl_float4& wi : samples.direction_pdf) ASSERT_TRUE(is_reflected(wi));
  record_law("X33");
}

// Through nothing light goes straight: no reflection at u = 0, and 2u for the cosine.
TEST(dielectric_test, equal_indices_change_nothing) {
  std::vector<Case> cases;
  for (const cl_float4& wo : upper_directions(84, 1000))
    for (cl_uint front : {0u, 1u}) cases.push_back({wo, 1.0f, front, 0.0f});
  const Scatters samples = sample(cases, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(samples.direction_pdf[i].s[axis], -cases[i].wo.s[axis], 4 * unit_roundoff);
    const cl_float4& weight = samples.weight_eta[i];
    ASSERT_TRUE(weight.s[0] == 0.3f && weight.s[1] == 0.2f && weight.s[2] == 0.1f && weight.s[3] == 1);
  }
}

// Extreme X37. The sine is scaled by one rounded index: Snell's law to 8u max(1, eta), the plane of incidence to 4u. The length,
// before or after renormalisation, 2e-6.
TEST(dielectric_test, refraction_obeys_snell_in_the_plane_of_incidence) {
  const std::vector<Case> cases = every_case(85, last);
  std::vector<cl_float4> wo, result(cases.size());
  std::vector<float> etas;
  std::vector<cl_uint> front;
  for (const Case& c : cases) wo.push_back(c.wo), etas.push_back(c.eta), front.push_back(c.front);
  run("dielectric_test.cl", "refracted", cases.size(), wo, etas, front, out(result));
  std::size_t refracted = 0;
  double worst = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const double eta = static_cast<double>(cases[i].relative()), cos_t = result[i].s[3];
    if (cos_t == 0) continue;
    ++refracted;
    const double x = wo[i].s[0], y = wo[i].s[1], sin_i = std::hypot(x, y);
    const double tx = result[i].s[0], ty = result[i].s[1], tz = result[i].s[2];
    ASSERT_LT(tz, 0);
    const double off = std::abs(std::hypot(tx, ty, tz) - 1);
    ASSERT_LE(off, 2e-6) << eta << " " << wo[i].s[2];
    worst = std::max(worst, off);
    ASSERT_NEAR(eta * std::hypot(tx, ty), sin_i, 8 * unit_roundoff * std::max(1.0, eta)) << eta << " " << wo[i].s[2];
    ASSERT_NEAR(x * ty - y * tx, 0, 4 * unit_roundoff) << eta << " " << wo[i].s[2];
    ASSERT_LE(x * tx + y * ty, 0) << "not on the same side of the normal";
    // wo has length 1 to 2u; its sine and its cosine disagree by that, which a cosine near 0 amplifies.
    ASSERT_NEAR(tz * tz, static_cast<double>(exact_cos2_t(wo[i].s[2], cases[i].relative())), 1e-6) << eta << " " << wo[i].s[2];
  }
  EXPECT_GT(refracted, cases.size() / 2);
  record_extreme("X37", worst, 2e-6);
}

// Refracted ones are renormalised: the drift of 1e-6 (extreme X37) squared, and 4u of rounding.
TEST(dielectric_test, sampled_directions_are_unit_vectors) {
  for (float u : {0.0f, last})
    for (const cl_float4& wi : sample(every_case(86, u)).direction_pdf)
      ASSERT_NEAR(std::hypot(wi.s[0], wi.s[1], wi.s[2]), 1, 4 * unit_roundoff);
}

// Into the glass and out again: the same direction but for twice the error of refraction, which outside is magnified by
// dcos_o / dcos_i = eta^2 cos_i / cos_o, so cosines below 0.1 are left out; and both factors of eta^2 cancel: 10u.
TEST(dielectric_test, the_way_out_undoes_the_way_in) {
  std::vector<Case> in;
  for (const Case& c : every_case(87, last))
    if (c.wo.s[2] > 0.1f && (c.relative() > 1 || c.wo.s[2] > critical_cosine(c.relative()) + 0.1L)) in.push_back(c);
  const Scatters there = sample(in);
  std::vector<Case> out_again;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const cl_float4& wi = there.direction_pdf[i];  // the path came from there, so wo is seen from the other side, turned upright
    out_again.push_back({{{wi.s[0], wi.s[1], -wi.s[2], 0}}, in[i].eta, 1 - in[i].front, last});
  }
  const Scatters back = sample(out_again);
  for (std::size_t i = 0; i < in.size(); ++i) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      ASSERT_NEAR(back.direction_pdf[i].s[axis], -there.direction_pdf[i].s[axis] * there.weight_eta[i].s[3], 2e-6);
    ASSERT_NEAR(-back.direction_pdf[i].s[2], in[i].wo.s[2], 2e-5);
    ASSERT_NEAR(static_cast<double>(there.weight_eta[i].s[0]) * back.weight_eta[i].s[0], 1, 10 * unit_roundoff);
    ASSERT_NEAR(static_cast<double>(there.weight_eta[i].s[3]) * back.weight_eta[i].s[3], 1, 3 * unit_roundoff);
  }
}

// Extreme X30: neither the length nor the direction drifts. 1e-5 rad after 500 plates, and 4u of length, which each step renews.
TEST(dielectric_test, a_thousand_refractions_keep_length_and_direction) {
  std::vector<cl_float4> wo;
  std::vector<oclair::Material> materials;
  for (float eta : {1.33f, 1.5f, 2.42f})
    for (const cl_float4& d : upper_directions(88, 200))
      if (d.s[2] > 0.1f) wo.push_back(d), materials.push_back(dielectric(eta));
  std::vector<cl_float4> result(wo.size());
  run("dielectric_test.cl", "cross_plates", wo.size(), materials, wo, static_cast<cl_uint>(count_or_small(1000, 100)), out(result));
  double worst = 0;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const cl_float4 &a = wo[i], &b = result[i];
    ASSERT_NEAR(std::hypot(b.s[0], b.s[1], b.s[2]), 1, 4 * unit_roundoff);
    const double off = std::hypot(a.s[0] - b.s[0], a.s[1] - b.s[1], a.s[2] - b.s[2]);
    ASSERT_LE(off, 1e-5) << materials[i].eta << " " << a.s[2];
    worst = std::max(worst, off);
  }
  record_extreme("X30", worst, 1e-5);
}
