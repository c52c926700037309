// What bsdf_sample draws against what bsdf_pdf says and what Fresnel's equations demand.
#include "bsdf_cases.h"
#include "diffuse_oracle.h"
#include "fresnel_oracle.h"
#include "quadrature.h"
#include "statistics.h"

using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;

Inputs from_one_direction(std::uint64_t seed, std::size_t count, double cosine, cl_uint front) {
  Inputs inputs = random_inputs(seed, count);
  const float sine = static_cast<float>(std::sqrt((1 - cosine) * (1 + cosine)));
  inputs.wo.assign(inputs.wo.size(), {{sine, 0, static_cast<float>(cosine), 0}});
  inputs.front.assign(inputs.wo.size(), front);
  return inputs;
}

}  // namespace

// The density, asked of the kernel, integrated by 4 nodes over each band of the cosine of the whole sphere (it does not depend on
// the azimuth). The lower half must stay empty.
TEST(bsdf_statistics, diffuse_models_are_sampled_as_their_density_says) {
  const std::size_t bands = 61, sectors = 24, count = count_or_small(1000000, 2000);
  std::vector<cl_float4> nodes;
  std::vector<double> weights;
  for (std::size_t band = 0; band < bands; ++band) {
    const double low = 2.0 * static_cast<double>(band) / bands - 1, high = 2.0 * static_cast<double>(band + 1) / bands - 1;
    // The density has a corner at the horizon: in the band across it, the upper half alone.
    for (const Node& node : gauss_legendre(4, std::max(low, low < 0 && high > 0 ? 0.0 : -1.0), high)) {
      nodes.push_back({{static_cast<float>(std::sqrt(1 - node.x * node.x)), 0, static_cast<float>(node.x), 0}});
      weights.push_back(node.weight * 2 * pi / sectors);
    }
  }
  for (const Model& model : models()) {
    if (model.is_delta) continue;
    const Values density = evaluate_bsdf(model.material, nodes);
    std::vector<double> expected(bands * sectors), observed(bands * sectors);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t sector = 0; sector < sectors; ++sector)
        expected[i / 4 * sectors + sector] += weights[i] * density.value_pdf[i].s[3] * static_cast<double>(count);
    const Scatters samples = sample_bsdf(model.material, from_one_direction(100, count, 0.6, 1));
    for (const cl_float4& wi : samples.direction_pdf) {
      const double turn = std::atan2(wi.s[1], wi.s[0]) / (2 * pi) + 0.5, height = (static_cast<double>(wi.s[2]) + 1) / 2;
      const std::size_t band = std::min(bands - 1, static_cast<std::size_t>(height * bands));
      ++observed[band * sectors + std::min(sectors - 1, static_cast<std::size_t>(turn * sectors))];
    }
    EXPECT_GT(chi_square_test(observed, expected), significance(4)) << model.name;
  }
}

// The mean weight from one direction is the directional albedo there, by its closed form.
TEST(bsdf_statistics, mean_weight_is_the_albedo) {
  const std::size_t count = count_or_small(1000000, 2000);
  for (const std::size_t which : {0u, 5u, 6u})
    for (const double cosine : {1.0, 0.5, 0.1}) {
      const Model& model = models()[which];
      const float sigma = model.material.roughness;
      const Exact expected = which == 0   ? 1
                             : which == 5 ? exact_oren_nayar_fast_albedo(std::acos(static_cast<Exact>(cosine)), sigma)
                                          : exact_disney_albedo(cosine, sigma);
      double sum = 0, squares = 0;
      for (const cl_float4& w : sample_bsdf(model.material, from_one_direction(103, count, cosine, 1)).weight_eta)
        sum += w.s[1], squares += static_cast<double>(w.s[1]) * w.s[1];
      const double n = static_cast<double>(count), mean = sum / n, error = std::sqrt(std::max(0.0, squares / n - mean * mean) / n);
      EXPECT_NEAR(mean, static_cast<double>(0.5L * expected), 4.7 * error + 1e-6) << model.name << " " << cosine;  // nine: 2e-5 / 9
    }
}

// Binomial: the share of reflected samples is the reflectance.
TEST(bsdf_statistics, glass_reflects_the_share_that_fresnel_says) {
  const std::vector<std::pair<double, cl_uint>> cases{{1.0, 1}, {0.7, 1}, {0.3, 1}, {0.05, 1}, {1.0, 0}, {0.9, 0}, {0.76, 0}};
  const std::size_t count = count_or_small(400000, 1000);
  for (const auto& [cosine, front] : cases) {
    const Scatters samples = sample_bsdf(models()[3].material, from_one_direction(101, count, cosine, front));
    double reflected = 0;
    for (const cl_float4& wi : samples.direction_pdf) reflected += wi.s[2] > 0;
    const double f = static_cast<double>(exact_reflectance(static_cast<float>(cosine), front ? 1.5L : 1 / 1.5L));
    const double n = static_cast<double>(count);
    EXPECT_GT(normal_tails((reflected - n * f) / std::sqrt(n * f * (1 - f))), significance(7)) << cosine << " " << front;
  }
}

// Schlick's polynomial in place of the exact equations, with the outer cosine: sin_o = 1.5 sin_i.
TEST(bsdf_statistics, glass_reflects_the_share_that_schlick_says_if_asked_to) {
  const std::size_t count = count_or_small(400000, 1000);
  for (const auto& [cosine, front] : {std::pair{0.3, 1u}, std::pair{0.1, 1u}, std::pair{0.76, 0u}}) {
    const Scatters samples =
        sample_bsdf(models()[3].material, from_one_direction(104, count, cosine, front), every_feature, oclair::APPROXIMATION_SCHLICK);
    double reflected = 0;
    for (const cl_float4& wi : samples.direction_pdf) reflected += wi.s[2] > 0;
    const double outer = front ? cosine : std::sqrt(1 - 2.25 * (1 - cosine * cosine));
    const double f = 0.04 + 0.96 * std::pow(1 - outer, 5), n = static_cast<double>(count);
    EXPECT_GT(normal_tails((reflected - n * f) / std::sqrt(n * f * (1 - f))), significance(3)) << cosine << " " << front;
  }
}

// R of one side at each angle: 2 R / (1 + R) of the paths come back.
TEST(bsdf_statistics, a_thin_sheet_reflects_two_r_over_one_plus_r) {
  const std::size_t count = count_or_small(400000, 1000);
  for (const double cosine : {1.0, 0.5, 0.2, 0.05}) {
    const Scatters samples = sample_bsdf(models()[7].material, from_one_direction(105, count, cosine, 1));
    double reflected = 0;
    for (const cl_float4& wi : samples.direction_pdf) reflected += wi.s[2] > 0;
    const double r = static_cast<double>(exact_reflectance(static_cast<float>(cosine), 1.5L)), f = 2 * r / (1 + r);
    const double n = static_cast<double>(count);
    EXPECT_GT(normal_tails((reflected - n * f) / std::sqrt(n * f * (1 - f))), significance(4)) << cosine;
  }
}

// Independent of the choice between reflection and refraction nothing else may depend on u: each branch has one direction.
TEST(bsdf_statistics, glass_knows_two_directions) {
  const Scatters samples = sample_bsdf(models()[3].material, from_one_direction(102, count_or_small(10000, 200), 0.5, 1));
  std::vector<std::array<float, 3>> seen;
  for (const cl_float4& wi : samples.direction_pdf) seen.push_back({wi.s[0], wi.s[1], wi.s[2]});
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::unique(seen.begin(), seen.end()) - seen.begin(), 2);
}
