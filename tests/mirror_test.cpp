#include "fresnel_oracle.h"
#include "scatter_cases.h"

using namespace oclair::test;

namespace {

Scatters sample(const char* kernel, const oclair::Material& material, const std::vector<cl_float4>& wo) {
  Scatters result(wo.size());
  run("mirror_test.cl", kernel, wo.size(), std::vector(wo.size(), material), wo, out(result.direction_pdf), out(result.weight_eta));
  return result;
}

// No rounding: two signs change.
void expect_reflected(const std::vector<cl_float4>& wo, const Scatters& samples) {
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const cl_float4& wi = samples.direction_pdf[i];
    ASSERT_TRUE(wi.s[0] == -wo[i].s[0] && wi.s[1] == -wo[i].s[1] && wi.s[2] == wo[i].s[2]);
    ASSERT_EQ(wi.s[3], 0.0f) << "a delta direction has no density";
    ASSERT_EQ(samples.weight_eta[i].s[3], 1.0f) << "no medium is crossed";
  }
}

}  // namespace

TEST(mirror_test, directions_are_reflected_exactly) {
  const std::vector<cl_float4> wo = upper_directions(70, count_or_small(10000, 100));
  expect_reflected(wo, sample("sample_mirror", mirror(0.9f, 0.5f, 0.1f), wo));
  expect_reflected(wo, sample("sample_conductor", conductor(), wo));
}

TEST(mirror_test, mirror_reflects_its_colour_at_every_angle) {
  const Scatters samples = sample("sample_mirror", mirror(0.9f, 0.5f, 0.1f), upper_directions(71, 1000));
  for (const cl_float4& weight : samples.weight_eta)
    ASSERT_TRUE(weight.s[0] == 0.9f && weight.s[1] == 0.5f && weight.s[2] == 0.1f);
}

// 1e-6 of the reflectance (fresnel_conductor_test) and the product's rounding.
TEST(mirror_test, conductor_reflects_its_colour_times_fresnel_of_each_channel) {
  const oclair::Material metal = conductor();
  const std::vector<cl_float4> wo = upper_directions(72, count_or_small(10000, 100));
  const Scatters samples = sample("sample_conductor", metal, wo);
  const std::array<float, 3> eta{metal.conductor_eta.x, metal.conductor_eta.y, metal.conductor_eta.z};
  const std::array<float, 3> k{metal.conductor_k.x, metal.conductor_k.y, metal.conductor_k.z};
  const std::array<float, 3> colour{metal.reflectance.x, metal.reflectance.y, metal.reflectance.z};
  for (std::size_t i = 0; i < wo.size(); ++i)
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double expected = static_cast<double>(colour[channel] * exact_conductor(wo[i].s[2], eta[channel], k[channel]));
      ASSERT_NEAR(samples.weight_eta[i].s[channel], expected, 1e-6 + unit_roundoff) << wo[i].s[2] << " " << channel;
    }
}

// The scene format's metal without a name has index 0 + 1i: all light comes back at every angle.
TEST(mirror_test, conductor_of_index_i_reflects_everything) {
  const Scatters samples = sample("sample_conductor", conductor({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), upper_directions(73, 1000));
  for (const cl_float4& weight : samples.weight_eta)
    for (std::size_t channel = 0; channel < 3; ++channel) ASSERT_NEAR(weight.s[channel], 1, 4 * unit_roundoff);
}

// Changing frames may round a cosine up to 1 + 4u.
TEST(mirror_test, cosine_rounded_above_one_counts_as_one) {
  for (const oclair::Material& metal : {conductor(), conductor({0.2f, 1.0f, 1.5f}, {0.1f, 0.01f, 0.0f}, {1, 1, 1})}) {
    const std::vector<cl_float4> wo{{{0, 0, 1, 0}}, {{0, 0, 1 + 0x1p-23f, 0}}, {{0, 0, 1 + 0x1p-22f, 0}}};
    const Scatters samples = sample("sample_conductor", metal, wo);
    for (std::size_t i = 1; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(samples.weight_eta[i].s[k], samples.weight_eta[0].s[k]) << k;
  }
}
