#include "fresnel_oracle.h"
#include "scatter_cases.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr packed_float3 mirrored{0.9f, 0.8f, 0.7f}, let_through{0.3f, 0.2f, 0.1f};

Scatters sample(const std::vector<Material>& materials, const std::vector<cl_float4>& wo, const std::vector<float>& u) {
  Scatters result(wo.size());
  run("thin_dielectric_test.cl", "sample", wo.size(), materials, wo, u, out(result.direction_pdf), out(result.weight_eta));
  return result;
}

// All orders of reflection between the sides: R + (1 - R)^2 R (1 + R^2 + R^4 + ...), summed term by term.
Exact summed_reflectance(Exact r) {
  Exact sum = r, term = (1 - r) * (1 - r) * r;
  for (int order = 0; order < 200000 && term > 1e-22L; ++order, term *= r * r) sum += term;
  return sum;
}

void expect_reflected(const cl_float4& wo, const cl_float4& wi, const cl_float4& weight) {
  ASSERT_TRUE(wi.s[0] == -wo.s[0] && wi.s[1] == -wo.s[1] && wi.s[2] == wo.s[2]);
  ASSERT_TRUE(weight.s[0] == mirrored.x && weight.s[1] == mirrored.y && weight.s[2] == mirrored.z);
}

void expect_transmitted(const cl_float4& wo, const cl_float4& wi, const cl_float4& weight) {
  ASSERT_TRUE(wi.s[0] == -wo.s[0] && wi.s[1] == -wo.s[1] && wi.s[2] == -wo.s[2]);
  ASSERT_TRUE(weight.s[0] == let_through.x && weight.s[1] == let_through.y && weight.s[2] == let_through.z);
}

}  // namespace

// The largest u that still reflects is the reflectance: 3e-6 below it every path is reflected, 3e-6 above it none. 1e-6 for R of one
// side (fresnel_test) becomes at most 2e-6, as d(2R/(1+R))/dR <= 2; the quotient rounds it by 3u more.
TEST(thin_dielectric_test, the_reflected_share_is_the_sum_of_all_orders) {
  std::vector<Material> materials;
  std::vector<cl_float4> wo;
  std::vector<float> u;
  std::vector<bool> reflects;
  constexpr Exact margin = 3e-6L;
  for (float eta : {1.0001f, 1.33f, 1.5f, 2.42f, 1e3f, 1 / 1.33f, 1 / 1.5f, 1 / 2.42f})
    for (const cl_float4& direction : upper_directions(220, count_or_small(1000, 30))) {
      if (std::abs(direction.s[2] - critical_cosine(eta)) < 1e-4L) continue;  // there the slope of R is not bounded
      const Exact share = summed_reflectance(exact_reflectance(direction.s[2], eta));
      const auto add = [&](Exact at, bool reflected) {
        if (at < 0 || at >= 1) return;
        materials.push_back(thin_dielectric(eta, mirrored, let_through)), wo.push_back(direction), u.push_back(static_cast<float>(at));
        reflects.push_back(reflected);
      };
      add(share - margin, true), add(share + margin, false), add(0, share > margin), add(1 - 0x1p-24L, share + margin >= 1);
      if (share + margin >= 1 && share < 1 - 0x1p-25L) materials.pop_back(), wo.pop_back(), u.pop_back(), reflects.pop_back();
    }
  const Scatters samples = sample(materials, wo, u);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    SCOPED_TRACE(testing::Message() << materials[i].eta << " cos " << wo[i].s[2] << " u " << u[i]);
    if (reflects[i])
      expect_reflected(wo[i], samples.direction_pdf[i], samples.weight_eta[i]);
    else if (u[i] > 0)
      expect_transmitted(wo[i], samples.direction_pdf[i], samples.weight_eta[i]);
    if (HasFatalFailure()) return;
  }
}

// Straight through or mirrored, without rounding; no medium is entered, and a delta has no density.
TEST(thin_dielectric_test, directions_and_weights_are_exact) {
  const std::size_t count = count_or_small(20000, 200);
  const std::vector<cl_float4> wo = upper_directions(221, count);
  std::vector<float> u;
  Random random(222);
  for (std::size_t i = 0; i < wo.size(); ++i) u.push_back(random.unit24());
  const Scatters samples = sample(std::vector(wo.size(), thin_dielectric(1.5f, mirrored, let_through)), wo, u);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const cl_float4& wi = samples.direction_pdf[i];
    if (wi.s[2] > 0) expect_reflected(wo[i], wi, samples.weight_eta[i]);
    else expect_transmitted(wo[i], wi, samples.weight_eta[i]);
    if (HasFatalFailure()) return;
    ASSERT_EQ(wi.s[3], 0.0f);
    ASSERT_EQ(samples.weight_eta[i].s[3], 1.0f);
  }
}

TEST(thin_dielectric_test, equal_indices_let_everything_through) {
  const std::vector<cl_float4> wo = upper_directions(223, 1000);
  const Scatters samples = sample(std::vector(wo.size(), thin_dielectric(1.0f, mirrored, let_through)), wo, std::vector<float>(wo.size(), 0.0f));
  for (std::size_t i = 0; i < wo.size(); ++i) expect_transmitted(wo[i], samples.direction_pdf[i], samples.weight_eta[i]);
}

// A sheet of thinner medium (a slit of air in water) beyond the critical angle.
TEST(thin_dielectric_test, a_sheet_of_thinner_medium_reflects_everything_beyond_the_critical_angle) {
  std::vector<cl_float4> wo;
  for (const cl_float4& d : upper_directions(224, 2000))
    if (d.s[2] < critical_cosine(1 / 1.5f) - 1e-6L) wo.push_back(d);
  const Scatters samples =
      sample(std::vector(wo.size(), thin_dielectric(1 / 1.5f, mirrored, let_through)), wo, std::vector<float>(wo.size(), 1 - 0x1p-24f));
  for (std::size_t i = 0; i < wo.size(); ++i) expect_reflected(wo[i], samples.direction_pdf[i], samples.weight_eta[i]);
}
