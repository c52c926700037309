// Albedo as --aov shows it, material by material: the kernel of aov_test.cl against the definitions in long double.
#include "fresnel_oracle.h"
#include "scatter_cases.h"

using namespace oclair;
using namespace oclair::test;

namespace {

std::vector<cl_float4> albedos(const std::vector<Material>& materials) {
  std::vector<cl_float4> result(materials.size());
  run("aov_test.cl", "albedo", materials.size(), materials, out(result));
  return result;
}

void expect_colour(const cl_float4& found, const std::array<Exact, 3>& expected, double tolerance) {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found.s[c], static_cast<double>(expected[c]), tolerance) << c;
}

}  // namespace

TEST(aov_test, albedo_of_diffuse_kinds_and_mirrors_is_their_reflectance_whatever_their_roughness) {
  std::vector<Material> materials = {diffuse(0.8f, 0.5f, 0.25f), mirror(0.8f, 0.5f, 0.25f)};
  for (const MaterialKind kind : {MATERIAL_OREN_NAYAR, MATERIAL_OREN_NAYAR_FAST, MATERIAL_DISNEY})
    for (const float roughness : {0.0f, 0.5f, 1.0f}) materials.push_back(rough(kind, roughness));
  for (const cl_float4& found : albedos(materials)) expect_colour(found, {0.8f, 0.5f, 0.25f}, 0.0);
}

// Two hypot of up to 4 ulp (8 u each), a quotient of up to 2.5 ulp, twice because it is squared, and two products: below 48
// u.
TEST(aov_test, albedo_of_a_conductor_is_its_reflectance_at_normal_incidence) {
  for (const float k : {0.0f, 0.5f, 4.0f, 1000.0f}) {
    const Material metal = conductor({0.143f, 1.0f, 2.5f}, {k, k, k}, {0.9f, 0.8f, 0.7f});
    expect_colour(albedos({metal})[0],
                  {Exact{0.9f} * exact_conductor(1, 0.143f, k), Exact{0.8f} * exact_conductor(1, 1.0f, k),
                   Exact{0.7f} * exact_conductor(1, 2.5f, k)},
                  48 * unit_roundoff);
  }
}

// The reflectance is (eta - 1)^2/(eta + 1)^2 by some ten roundings, and the mix has three of its own: below 16 u of 1.
TEST(aov_test, albedo_of_dielectrics_is_all_that_they_send_on_at_normal_incidence) {
  const std::array<Exact, 3> reflected = {0.9f, 0.8f, 0.7f}, transmitted = {0.3f, 0.2f, 0.1f};
  for (const float eta : {1.0f, 1.0001f, 1.5f, 2.4f, 0.5f}) {
    const auto expected = [&](Exact share) {
      std::array<Exact, 3> colour;
      for (std::size_t c = 0; c < 3; ++c) colour[c] = share * reflected[c] + (1 - share) * transmitted[c];
      return colour;
    };
    const Exact one_side = exact_reflectance(1, eta);
    const auto found =
        albedos({dielectric(eta, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f}),
                 thin_dielectric(eta, {0.9f, 0.8f, 0.7f}, {0.3f, 0.2f, 0.1f}), dielectric(eta), thin_dielectric(eta)});
    expect_colour(found[0], expected(one_side), 16 * unit_roundoff);
    // All orders of reflection between the two sides, summed.
    Exact sheet = one_side, between = (1 - one_side) * (1 - one_side) * one_side;
    for (int order = 0; order < 200; ++order, between *= one_side * one_side) sheet += between;
    expect_colour(found[1], expected(sheet), 16 * unit_roundoff);
    expect_colour(found[2], {1, 1, 1}, 0.0);  // clear glass keeps all light
    expect_colour(found[3], {1, 1, 1}, 0.0);
  }
}
