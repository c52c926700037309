#include "quadrature.h"
#include "scatter_cases.h"

using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;
const oclair::Material paint = diffuse(0.8f, 0.5f, 0.25f);

std::vector<cl_float4> evaluate(const oclair::Material& material, const std::vector<cl_float4>& wi) {
  std::vector<cl_float4> result(wi.size());
  run("diffuse_test.cl", "evaluate", wi.size(), std::vector(wi.size(), material), wi, out(result));
  return result;
}

std::vector<cl_float2> squares() {
  std::vector<cl_float2> list;
  for (float x : {0.0f, 0x1p-24f, 0.5f, 1 - 0x1p-24f})
    for (float y : {0.0f, 0x1p-24f, 0.5f, 1 - 0x1p-24f}) list.push_back({{x, y}});
  Random random(60);
  for (std::size_t i = 0; i < count_or_small(100000, 100); ++i)
    list.push_back({{static_cast<float>(random.engine() >> 40) * 0x1p-24f, static_cast<float>(random.engine() >> 40) * 0x1p-24f}});
  return list;
}

Scatters sample(const oclair::Material& material, const std::vector<cl_float2>& u) {
  Scatters result(u.size());
  run("diffuse_test.cl", "sample", u.size(), std::vector(u.size(), material), u, out(result.direction_pdf), out(result.weight_eta));
  return result;
}

}  // namespace

// Lambert: albedo / pi times the cosine; one constant, two products: 3u.
TEST(diffuse_test, value_is_albedo_over_pi_times_the_cosine) {
  const std::vector<cl_float4> wi = upper_directions(61, count_or_small(10000, 100)), value = evaluate(paint, wi);
  for (std::size_t i = 0; i < wi.size(); ++i) {
    const std::array<double, 4> expected{0.8f * wi[i].s[2] / pi, 0.5 * wi[i].s[2] / pi, 0.25 * wi[i].s[2] / pi, wi[i].s[2] / pi};
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(value[i].s[k], expected[k], 3 * unit_roundoff * expected[k]) << k;
  }
}

TEST(diffuse_test, nothing_is_scattered_to_the_other_side) {
  std::vector<cl_float4> wi = upper_directions(62, 1000);
  for (cl_float4& d : wi) d.s[2] = -d.s[2];
  wi.push_back({{1, 0, 0, 0}});
  wi.push_back({{1, 0, -0.0f, 0}});
  for (const cl_float4& value : evaluate(paint, wi))
    for (float component : value.s) ASSERT_EQ(component, 0.0f);
}

// The integrand does not depend on the azimuth and is linear in the cosine: 8 nodes by 8 azimuths are exact up to rounding.
TEST(diffuse_test, albedo_by_quadrature_is_the_reflectance) {
  std::vector<cl_float4> wi;
  std::vector<double> weight;
  for (const Node& node : gauss_legendre(8, 0, 1))
    for (int k = 0; k < 8; ++k) {
      const double r = std::sqrt((1 - node.x) * (1 + node.x)), phi = 2 * pi * k / 8;
      wi.push_back({{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(node.x), 0}});
      weight.push_back(node.weight * 2 * pi / 8);
    }
  std::array<double, 4> integral{};
  const std::vector<cl_float4> value = evaluate(paint, wi);
  for (std::size_t i = 0; i < wi.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) integral[k] += weight[i] * value[i].s[k];
  EXPECT_NEAR(integral[0], 0.8, 2.5e-6);
  EXPECT_NEAR(integral[1], 0.5, 2.5e-6);
  EXPECT_NEAR(integral[2], 0.25, 2.5e-6);
  EXPECT_NEAR(integral[3], 1.0, 2.5e-6);  // the density
}

// The cosine and pi cancel: never divide by the density.
TEST(diffuse_test, weight_of_a_sample_is_the_albedo_exactly) {
  const Scatters samples = sample(paint, squares());
  for (const cl_float4& w : samples.weight_eta) {
    ASSERT_EQ(w.s[0], 0.8f);
    ASSERT_EQ(w.s[1], 0.5f);
    ASSERT_EQ(w.s[2], 0.25f);
    ASSERT_EQ(w.s[3], 1.0f);
  }
}

TEST(diffuse_test, samples_know_their_density_and_value) {
  const Scatters samples = sample(paint, squares());
  std::vector<cl_float4> wi = samples.direction_pdf;
  const std::vector<cl_float4> value = evaluate(paint, wi);
  for (std::size_t i = 0; i < wi.size(); ++i) {
    ASSERT_GT(wi[i].s[3], 0.0f);
    ASSERT_NEAR(std::hypot(wi[i].s[0], wi[i].s[1], wi[i].s[2]), 1, 3e-7);
    ASSERT_NEAR(wi[i].s[3], wi[i].s[2] / pi, 3 * unit_roundoff * wi[i].s[3]);
    for (std::size_t k = 0; k < 3; ++k)  // weight * density: 4u for the product and the rounding of both sides
      ASSERT_NEAR(static_cast<double>(samples.weight_eta[i].s[k]) * wi[i].s[3], value[i].s[k], 5 * unit_roundoff * value[i].s[k]);
  }
}
