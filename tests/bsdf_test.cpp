#include "bsdf_cases.h"

#include <cstring>

#include "diffuse_oracle.h"
#include "fresnel_oracle.h"
#include "quadrature.h"

using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;

bool same_bits(const std::vector<cl_float4>& a, const std::vector<cl_float4>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

// Any direction, above and below.
std::vector<cl_float4> all_directions(std::size_t count) {
  std::vector<cl_float4> list = upper_directions(90, count);
  for (std::size_t i = 0; i < list.size(); i += 2) list[i].s[2] = -list[i].s[2];
  return list;
}

}  // namespace

TEST(bsdf_test, the_diffuse_models_are_not_deltas_and_the_others_are) {
  for (const Model& model : models())
    EXPECT_EQ(evaluate_bsdf(model.material, {{{0, 0, 1, 0}}}).is_delta[0] != 0, model.is_delta) << model.name;
}

TEST(bsdf_test, deltas_have_no_value_and_no_density) {
  for (const Model& model : models()) {
    if (!model.is_delta) continue;
    const Inputs inputs = random_inputs(91, 1000);
    for (const cl_float4& value : evaluate_bsdf(model.material, all_directions(1000)).value_pdf)
      for (float component : value.s) ASSERT_EQ(component, 0.0f) << model.name;
    for (const cl_float4& wi : sample_bsdf(model.material, inputs).direction_pdf) ASSERT_EQ(wi.s[3], 0.0f) << model.name;
  }
}

// 8u: both sides are products of a few rounded numbers.
TEST(bsdf_test, weight_times_density_is_the_value) {
  for (const Model& model : models()) {
    const Inputs inputs = random_inputs(92, count_or_small(20000, 100));
    const Scatters samples = sample_bsdf(model.material, inputs);
    const Values values = evaluate_bsdf(model.material, samples.direction_pdf, every_feature, inputs.wo);
    for (std::size_t i = 0; i < samples.direction_pdf.size(); ++i) {
      const double pdf = samples.direction_pdf[i].s[3];
      ASSERT_NEAR(values.value_pdf[i].s[3], pdf, 8 * unit_roundoff * pdf) << model.name;
      for (std::size_t k = 0; k < 3; ++k) {
        const double product = samples.weight_eta[i].s[k] * pdf;
        ASSERT_NEAR(values.value_pdf[i].s[k], product, 8 * unit_roundoff * product) << model.name;
      }
    }
  }
}

// Of each model's own colours: what a swapped branch of the switch would mix up.
TEST(bsdf_test, every_model_scatters_with_its_own_weights) {
  const Inputs inputs = random_inputs(93, count_or_small(4000, 100));
  const auto count_of = [&](const Scatters& samples, auto condition) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < inputs.wo.size(); ++i)
      n += condition(inputs.wo[i], samples.direction_pdf[i], samples.weight_eta[i]) ? 1u : 0u;
    return n;
  };
  const auto reflected = [](const cl_float4& wo, const cl_float4& wi) {
    return wi.s[0] == -wo.s[0] && wi.s[1] == -wo.s[1] && wi.s[2] == wo.s[2];
  };
  const std::size_t all = inputs.wo.size();
  EXPECT_EQ(count_of(sample_bsdf(models()[0].material, inputs), [&](auto& wo, auto& wi, auto& w) {
    return !reflected(wo, wi) && wi.s[2] > 0 && w.s[0] == 0.8f && w.s[1] == 0.5f && w.s[2] == 0.25f && w.s[3] == 1;
  }), all);
  EXPECT_EQ(count_of(sample_bsdf(models()[1].material, inputs), [&](auto& wo, auto& wi, auto& w) {
    return reflected(wo, wi) && w.s[0] == 0.9f && w.s[1] == 0.5f && w.s[2] == 0.1f && w.s[3] == 1;
  }), all);
  EXPECT_EQ(count_of(sample_bsdf(models()[2].material, inputs), [&](auto& wo, auto& wi, auto& w) {
    const oclair::Material& metal = models()[2].material;
    const Exact red = metal.reflectance.x * exact_conductor(wo.s[2], metal.conductor_eta.x, metal.conductor_k.x);
    return reflected(wo, wi) && std::abs(w.s[0] - red) < 2e-6L && w.s[3] == 1;
  }), all);
  const Scatters glass = sample_bsdf(models()[3].material, inputs);
  const std::size_t back = count_of(glass, [&](auto& wo, auto& wi, auto& w) { return reflected(wo, wi) && w.s[0] == 0.9f; });
  const std::size_t in = count_of(glass, [](auto&, auto& wi, auto& w) { return wi.s[2] < 0 && w.s[3] == 1.5f; });
  const std::size_t outwards =
      count_of(glass, [](auto&, auto& wi, auto& w) { return wi.s[2] < 0 && std::abs(w.s[3] - 1 / 1.5f) < 1e-7f; });
  EXPECT_EQ(back + in + outwards, all);
  EXPECT_GT(back, 0u);
  EXPECT_GT(in, 0u);
  EXPECT_GT(outwards, 0u);
  // The rough models at this roughness, by their papers' formulas; 3e-6 is 15 u pi (oren_nayar_test).
  for (std::size_t model : {4u, 5u, 6u}) {
    EXPECT_EQ(count_of(sample_bsdf(models()[model].material, inputs), [&](auto& wo, auto& wi, auto& w) {
      const Angles a = angles_of(wi, wo);
      const Exact o = wo.s[2], i = wi.s[2], cos2_d = (1 + (wo.s[0] * Exact(wi.s[0]) + wo.s[1] * Exact(wi.s[1]) + o * i)) / 2;
      const Exact factor = model == 4   ? exact_oren_nayar(a, 0.5L, 0.25L)
                           : model == 5 ? 0.25L * exact_oren_nayar_fast(a, 0.5L)
                                        : 0.25L * exact_disney(i, o, std::sqrt(cos2_d), 0.75L);
      return !reflected(wo, wi) && i > 0 && std::abs(w.s[2] - factor) <= 3e-6L / i && w.s[3] == 1;
    }), all) << models()[model].name;
  }
  const Scatters sheet = sample_bsdf(models()[7].material, inputs);
  const std::size_t off = count_of(sheet, [&](auto& wo, auto& wi, auto& w) { return reflected(wo, wi) && w.s[0] == 0.9f && w.s[3] == 1; });
  const std::size_t through = count_of(sheet, [](auto& wo, auto& wi, auto& w) { return wi.s[2] == -wo.s[2] && w.s[0] == 0.3f && w.s[3] == 1; });
  EXPECT_EQ(off + through, all);
  EXPECT_GT(off, 0u);
  EXPECT_GT(through, 0u);
}

// The numbering of random dimensions (rng.h) gives the choice the first of the two.
TEST(bsdf_test, the_first_random_number_chooses_between_reflection_and_refraction) {
  const cl_float4 wo{{0.6f, 0, 0.8f, 0}};
  const Inputs inputs{{wo, wo}, {1, 1}, {{{0, 0.999f}}, {{0.999f, 0}}}};
  for (const std::size_t model : {3u, 7u}) {
    const Scatters samples = sample_bsdf(models()[model].material, inputs);
    EXPECT_GT(samples.direction_pdf[0].s[2], 0) << models()[model].name;
    EXPECT_LT(samples.direction_pdf[1].s[2], 0) << models()[model].name;
  }
}

// So that a feature bit forgotten by the host is a black surface, and the compiler removes what is off.
TEST(bsdf_test, what_a_kernel_is_not_compiled_for_is_black) {
  const Inputs inputs = random_inputs(96, 200);
  for (const Model& model : models()) {
    const Scatters samples = sample_bsdf(model.material, inputs, every_feature & ~model.feature);
    const Values values = evaluate_bsdf(model.material, inputs.wo, every_feature & ~model.feature);
    for (std::size_t i = 0; i < inputs.wo.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(samples.weight_eta[i].s[k], 0.0f) << model.name;
      for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(values.value_pdf[i].s[k], 0.0f) << model.name;
    }
  }
}

// Then light sampling and its traversal are removed.
TEST(bsdf_test, a_kernel_without_diffuse_models_knows_deltas_only) {
  for (const Model& model : models())
    for (const cl_uint is_delta : evaluate_bsdf(model.material, {{{0, 0, 1, 0}}}, oclair::FEATURE_MIRROR | oclair::FEATURE_THIN_DIELECTRIC).is_delta)
      EXPECT_TRUE(is_delta) << model.name;
}

// A sheet has no inside: its front and its back, and its index ratio, are the same.
TEST(bsdf_test, a_thin_dielectric_is_the_same_from_both_sides) {
  Inputs inputs = random_inputs(97, count_or_small(5000, 100));
  const oclair::Material& sheet = models()[7].material;
  inputs.front.assign(inputs.wo.size(), 1);
  const Scatters front = sample_bsdf(sheet, inputs);
  inputs.front.assign(inputs.wo.size(), 0);
  const Scatters back = sample_bsdf(sheet, inputs);
  EXPECT_TRUE(same_bits(front.direction_pdf, back.direction_pdf));
  EXPECT_TRUE(same_bits(front.weight_eta, back.weight_eta));
}

// 8 nodes by 8 azimuths are exact for Lambert up to rounding.
TEST(bsdf_test, albedo_of_diffuse_by_quadrature_is_its_reflectance) {
  std::vector<cl_float4> wi;
  std::vector<double> weight;
  for (const Node& node : gauss_legendre(8, 0, 1))
    for (int k = 0; k < 8; ++k) {
      const double r = std::sqrt((1 - node.x) * (1 + node.x)), phi = 2 * pi * k / 8;
      wi.push_back({{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(node.x), 0}});
      weight.push_back(node.weight * 2 * pi / 8);
    }
  const Values values = evaluate_bsdf(models()[0].material, wi);
  std::array<double, 4> integral{};
  for (std::size_t i = 0; i < wi.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) integral[k] += weight[i] * values.value_pdf[i].s[k];
  const std::array<double, 4> expected{0.8f, 0.5, 0.25, 1};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(integral[k], expected[k], 2.5e-6);
}

// A kernel that is compiled for what the scene has must give the image of the one compiled for everything.
TEST(bsdf_test, specialised_kernels_give_the_same_bits) {
  const Inputs inputs = random_inputs(94, count_or_small(20000, 200));
  const std::vector<cl_float4> directions = all_directions(count_or_small(2000, 100));
  for (const Model& model : models()) {
    const Scatters all = sample_bsdf(model.material, inputs), special = sample_bsdf(model.material, inputs, model.feature);
    EXPECT_TRUE(same_bits(all.direction_pdf, special.direction_pdf)) << model.name;
    EXPECT_TRUE(same_bits(all.weight_eta, special.weight_eta)) << model.name;
    const Values value = evaluate_bsdf(model.material, directions);
    const Values special_value = evaluate_bsdf(model.material, directions, model.feature);
    EXPECT_TRUE(same_bits(value.value_pdf, special_value.value_pdf)) << model.name;
    EXPECT_EQ(value.is_delta, special_value.is_delta) << model.name;
  }
}

// Two features at once, each model with its neighbour and with the third from it: neither may answer for the other.
TEST(bsdf_test, kernels_for_two_models_give_the_same_bits) {
  const Inputs inputs = random_inputs(95, count_or_small(5000, 100));
  for (std::size_t a = 0; a < models().size(); ++a)
    for (std::size_t b : {(a + 1) % models().size(), (a + 3) % models().size()})
      for (std::size_t which : {a, b}) {
        const Scatters all = sample_bsdf(models()[which].material, inputs);
        const Scatters special = sample_bsdf(models()[which].material, inputs, models()[a].feature | models()[b].feature);
        EXPECT_TRUE(same_bits(all.direction_pdf, special.direction_pdf)) << models()[a].name << " and " << models()[b].name;
        EXPECT_TRUE(same_bits(all.weight_eta, special.weight_eta)) << models()[a].name << " and " << models()[b].name;
      }
}
