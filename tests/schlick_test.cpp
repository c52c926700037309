// Schlick's approximation of Fresnel's equations (Schlick 1994, eq. 15), which --fresnel schlick asks for.
#include <cstring>

#include "fresnel_oracle.h"
#include "inputs.h"
#include "kernel.h"
#include "quadrature.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

struct Row {
  float cosine, eta;
  cl_uint front;
  Exact relative() const { return front ? Exact(eta) : 1 / Exact(eta); }
};

struct Results {
  std::vector<cl_float4> chosen, exact;
};

Results run_rows(const std::vector<Row>& rows, Approximations approximations) {
  std::vector<float> cosine, eta;
  std::vector<cl_uint> front;
  for (const Row& row : rows) cosine.push_back(row.cosine), eta.push_back(row.eta), front.push_back(row.front);
  Results results{std::vector<cl_float4>(rows.size()), std::vector<cl_float4>(rows.size())};
  run_with({every_feature, 8, 64, approximations}, "schlick_test.cl", "dielectric", rows.size(), cosine, eta, front, out(results.chosen),
           out(results.exact));
  return results;
}

Exact normal_reflectance(Exact eta) { return (1 - eta) * (1 - eta) / ((1 + eta) * (1 + eta)); }

Exact polynomial(Exact cosine, Exact r0) { return r0 + (1 - r0) * std::pow(1 - cosine, 5); }

// With the cosine on the side of the thinner medium; beyond the critical angle everything is reflected; equal indices are no surface.
Exact exact_schlick(Exact c, Exact eta) {
  if (eta == 1) return 0;
  const Exact cos2_t = exact_cos2_t(c, eta);
  if (cos2_t <= 0) return 1;
  return polynomial(eta < 1 ? std::sqrt(cos2_t) : c, normal_reflectance(eta));
}

// Every index of extreme X36, from both sides.
std::vector<Row> every_row() {
  std::vector<Row> rows;
  for (float eta : {1.0f, 1.000001f, 1.0001f, 1.33f, 1.5f, 2.42f, 1e3f, 1e6f, 1 / 1.000001f, 1 / 1.0001f, 1 / 1.33f, 1 / 1.5f, 1 / 2.42f, 1e-3f, 1e-6f})
    for (cl_uint front : {1u, 0u}) {
      for (int k = 0; k <= 20; ++k) rows.push_back({static_cast<float>(std::pow(10.0, -k)), eta, front});
      const int steps = static_cast<int>(count_or_small(2048, 16));
      for (int k = 0; k < steps; ++k) rows.push_back({static_cast<float>(k) / static_cast<float>(steps), eta, front});
      const float critical = static_cast<float>(critical_cosine(rows.back().relative()));
      for (int k = -20; k <= 20; ++k)
        if (critical > 0 && critical < 0.9999f) rows.push_back({critical * (1 + static_cast<float>(k) * 0x1p-20f), eta, front});
    }
  return rows;
}

bool operator==(const cl_float4& a, const cl_float4& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

// Degrees, exact, Schlick; computed with 30 digits. The third column judges this file's own formula too.
TEST(schlick_test, dielectrics_meet_published_values) {
  struct Published {
    double eta;
    cl_uint front;
    double degrees, reflectance;
  };
  const std::vector<Published> table{{1.5, 1, 0, .04}, {1.5, 1, 30, .0400414365}, {1.5, 1, 50, .0455834651}, {1.5, 1, 60, .07},
                                     {1.5, 1, 70, .158395235}, {1.5, 1, 75, .254729884}, {1.5, 1, 80, .409910091}, {1.5, 1, 85, .648491718},
                                     {1.5, 1, 89, .919101892}, {2.42, 1, 60, .198257584}, {2.42, 1, 75, .357511114}, {2.42, 1, 80, .491290205},
                                     {2.42, 1, 85, .696968711}, {2.42, 1, 89, .930258662}, {1.5, 0, 30, .0442703}, {1.5, 0, 40, .2455834},
                                     {1.5, 0, 41.8, .9074824}, {2.42, 0, 20, .1858603}, {2.42, 0, 24, .4858470}, {2.42, 0, 24.4, .9054606},
                                     {1.5, 0, 42, 1}, {2.42, 0, 30, 1}};
  std::vector<Row> rows;
  for (const Published& p : table) rows.push_back({static_cast<float>(std::cos(p.degrees * degree)), static_cast<float>(p.eta), p.front});
  const Results results = run_rows(rows, APPROXIMATION_SCHLICK);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Exact c = std::cos(static_cast<Exact>(table[i].degrees) * 3.14159265358979323846L / 180);
    const Exact eta = static_cast<Exact>(table[i].eta);
    EXPECT_NEAR(static_cast<double>(exact_schlick(c, table[i].front ? eta : 1 / eta)), table[i].reflectance, 6e-8) << i;
    // .007 degrees before the critical angle the slope over the inner cosine is 5 (1 - t)^4 eta^2 c / t < 1200.
    EXPECT_NEAR(results.chosen[i].s[0], table[i].reflectance, 1e-7 + (table[i].front ? 8 : 1200) * unit_roundoff) << i;
  }
}

// Entering, it is a polynomial: 1 - c rounds by u/2 where it is above 1/2, times 5; three products, the sum, 1 - R0 and R0, each u/2
// or u of it: 6u. Leaving, the transmitted cosine t comes in: its square errs by 8u (fresnel_test), and so t by at most
// min(8u / t, sqrt(8u)), times 5.
TEST(schlick_test, dielectric_reflectance_is_the_polynomial_of_the_larger_angle) {
  const std::vector<Row> rows = every_row();
  const Results results = run_rows(rows, APPROXIMATION_SCHLICK);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Exact eta = rows[i].relative(), expected = exact_schlick(rows[i].cosine, eta);
    Exact tolerance = 6 * unit_roundoff;
    if (eta < 1) {
      const Exact cos2_t = exact_cos2_t(rows[i].cosine, eta);
      if (std::abs(cos2_t) < 8 * unit_roundoff)  // either side of the critical angle
        tolerance += 5 * std::sqrt(16 * Exact(unit_roundoff));
      else if (cos2_t > 0)
        tolerance += 5 * std::min(8 * unit_roundoff / std::sqrt(cos2_t), std::sqrt(8 * Exact(unit_roundoff)));
    }
    ASSERT_NEAR(results.chosen[i].s[0], static_cast<double>(expected), static_cast<double>(tolerance))
        << "cos " << rows[i].cosine << " eta " << rows[i].eta << " front " << rows[i].front;
    if (results.exact[i].s[1] > 0) {
      ASSERT_NEAR(static_cast<double>(results.chosen[i].s[0]) + results.chosen[i].s[1], 1, unit_roundoff);
    }
  }
}

TEST(schlick_test, angles_and_total_reflection_stay_exact) {
  const std::vector<Row> rows = every_row();
  const Results results = run_rows(rows, APPROXIMATION_SCHLICK);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(results.chosen[i].s[2], results.exact[i].s[2]);
    if (results.exact[i].s[2] == 0 || rows[i].eta == 1) {
      ASSERT_TRUE(results.chosen[i] == results.exact[i]);
    }
  }
}

TEST(schlick_test, without_the_option_the_equations_are_exact_bit_for_bit) {
  const std::vector<Row> rows = every_row();
  const Results off = run_rows(rows, 0), on = run_rows(rows, APPROXIMATION_SCHLICK);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_TRUE(off.chosen[i] == off.exact[i]);
    ASSERT_TRUE(on.exact[i] == off.exact[i]);
  }
}

// Largest difference from the exact equations: what the documentation states. Entering.
TEST(schlick_test, its_largest_error_is_as_documented) {
  for (const auto& [eta, degrees, error] : {std::array{1.5, 84.974, .0356926}, std::array{2.42, 84.51, .0756912}}) {
    double largest = 0, at = 0;
    std::vector<Row> rows;
    for (int k = 0; k <= 9000; ++k) rows.push_back({static_cast<float>(std::cos(0.01 * k * degree)), static_cast<float>(eta), 1});
    if (small_inputs()) rows.resize(10);
    const Results results = run_rows(rows, APPROXIMATION_SCHLICK);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double difference = std::abs(static_cast<double>(results.chosen[i].s[0]) - results.exact[i].s[0]);
      if (difference > largest) largest = difference, at = 0.01 * static_cast<double>(i);
    }
    if (small_inputs()) return;
    EXPECT_NEAR(largest, error, 2e-6) << eta;  // 1e-6 of the exact equations, and 6u
    EXPECT_NEAR(at, degrees, 0.2) << eta;      // the maximum is flat
  }
}

// F0 = ((eta - 1)^2 + k^2)/((eta + 1)^2 + k^2): two hypots of 4 ulp, a quotient, a square: 22u; then the polynomial's 6u.
TEST(schlick_test, conductors_begin_at_their_reflectance_at_normal_incidence) {
  std::vector<float> cosine, eta, k;
  for (float n : {0.0f, 1e-3f, 0.06f, 0.155f, 1.0f, 1.2f, 5.0f, 100.0f})
    for (float extinction : {0.0f, 1e-3f, 1.0f, 3.6f, 7.26f, 1e3f, 1e10f, 1e19f})
      for (float c : {0.0f, 1e-7f, 0.1f, 0.3f, 0.5f, 0.7f, 0.9f, 1.0f}) cosine.push_back(c), eta.push_back(n), k.push_back(extinction);
  std::vector<float> chosen(cosine.size()), exact(cosine.size());
  run_with({every_feature, 8, 64, APPROXIMATION_SCHLICK}, "schlick_test.cl", "conductor", cosine.size(), cosine, eta, k, out(chosen), out(exact));
  for (std::size_t i = 0; i < cosine.size(); ++i) {
    const Exact n = eta[i], e = k[i], f0 = ((n - 1) * (n - 1) + e * e) / ((n + 1) * (n + 1) + e * e);
    ASSERT_NEAR(chosen[i], static_cast<double>(polynomial(cosine[i], f0)), 28 * unit_roundoff) << cosine[i] << " " << eta[i] << " " << k[i];
  }
  std::vector<float> off(cosine.size());
  run("schlick_test.cl", "conductor", cosine.size(), cosine, eta, k, out(off), out(exact));
  for (std::size_t i = 0; i < cosine.size(); ++i) ASSERT_EQ(off[i], exact[i]);
}

// The integral of the polynomial times 2c is R0 20/21 + 1/21; 8 nodes are exact.
TEST(schlick_test, cosine_averaged_reflectance_is_twenty_parts_of_r0_and_one) {
  for (float eta : {1.33f, 1.5f, 2.42f}) {
    std::vector<Row> rows;
    for (const Node& node : gauss_legendre(8, 0, 1)) rows.push_back({static_cast<float>(node.x), eta, 1});
    const Results results = run_rows(rows, APPROXIMATION_SCHLICK);
    double average = 0;
    std::size_t i = 0;
    for (const Node& node : gauss_legendre(8, 0, 1)) average += node.weight * 2 * node.x * results.chosen[i++].s[0];
    EXPECT_NEAR(average, static_cast<double>((20 * normal_reflectance(eta) + 1) / 21), 12 * unit_roundoff) << eta;
  }
}
