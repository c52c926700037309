#include "extremes.h"
#include "fresnel_oracle.h"
#include "inputs.h"
#include "kernel.h"
#include "quadrature.h"

using namespace oclair::test;

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

struct Row {
  cl_float cosine, eta;
  cl_uint front;
  // The index ratio that the arguments stand for, not a rounded one.
  Exact true_eta() const { return front ? Exact(eta) : 1 / Exact(eta); }
};

std::vector<cl_float4> run_rows(const std::vector<Row>& rows) {
  std::vector<float> cosine, eta;
  std::vector<cl_uint> front;
  for (const Row& row : rows) cosine.push_back(row.cosine), eta.push_back(row.eta), front.push_back(row.front);
  std::vector<cl_float4> result(rows.size());
  run("fresnel_test.cl", "dielectric", rows.size(), cosine, eta, front, out(result));
  return result;
}

// Extreme X36: indices of air, almost air, water, glass, diamond and absurd ones, as the back's index and as the front's.
const std::vector<float>& indices() {
  static const std::vector<float> list{1.0f,  1.000001f,  1.0001f,  1.33f,  1.5f,  2.42f,  1e3f,  1e6f,
                                       1 / 1.000001f, 1 / 1.0001f, 1 / 1.33f, 1 / 1.5f, 1 / 2.42f, 1e-3f, 1e-6f};
  return list;
}

std::vector<float> cosines(Exact eta) {
  std::vector<float> list{0.0f, 1.0f};
  for (int k = 1; k <= 20; ++k) list.push_back(static_cast<float>(std::pow(10.0, -k)));
  for (int k = 1; k <= 8; ++k) list.push_back(1 - static_cast<float>(k) * 0x1p-24f);
  const int steps = static_cast<int>(count_or_small(4096, 16));
  for (int k = 1; k < steps; ++k) list.push_back(static_cast<float>(k) / static_cast<float>(steps));
  const float critical = static_cast<float>(critical_cosine(eta));
  if (critical > 0)
    for (int k = -20; k <= 20; ++k)
      for (float scale : {1.0f, 30.0f, 1000.0f}) {
        const float c = critical * (1 + static_cast<float>(k) * scale * 0x1p-23f);
        if (c <= 1) list.push_back(c);
      }
  return list;
}

std::vector<Row> every_row() {
  std::vector<Row> rows;
  for (float eta : indices())
    for (cl_uint front : {1u, 0u})
      for (float cosine : cosines(Row{0, eta, front}.true_eta())) rows.push_back({cosine, eta, front});
  return rows;
}

std::string describe(const Row& row) {
  char text[100];
  std::snprintf(text, sizeof text, "cos %.9g eta %.9g front %u", static_cast<double>(row.cosine),
                static_cast<double>(row.eta), row.front);
  return text;
}

// Error of a result, absolute or relative, from what the formula gives for some cosine within 4u of the given one.
// Away from the critical angle the second freedom is below 3e-7. Near it no float code has a small error for the given cosine:
// rounding eta^2 alone (u) moves the critical cosine by u eta^2 / (2 cos), and there dF/dcos is 460 still at a distance of 1e-4
// (eta = 1.33), which makes 6e-6 of that rounding. The values between those at the ends count too; the formula is not monotonous
// (it dips at Brewster's angle), so where the ends do not bracket the result, the cosines between them are tried.
// Returns the error beyond them.
double error_of(Exact formula(Exact, Exact), const Row& row, Exact result, bool relative) {
  constexpr int steps = 128;
  const auto at = [&](int k) {
    return formula(std::min(row.cosine * (1 + k * (4 * Exact(unit_roundoff) / steps)), Exact(1)), row.true_eta());
  };
  Exact least = std::min(at(-steps), at(steps)), most = std::max(at(-steps), at(steps));
  const auto beyond = [&] {
    const Exact below = (least - result) / (relative ? least : 1), above = (result - most) / (relative ? most : 1);
    return result >= least && result <= most ? 0.0 : static_cast<double>(std::max(below, above));
  };
  for (int k = -steps; k <= steps && !(beyond() <= 1e-6); ++k) least = std::min(least, at(k)), most = std::max(most, at(k));
  return beyond();
}

}  // namespace

// Tables computed with 30 digits, for the oracle itself: it is judged here and judges below.
TEST(fresnel_test, oracle_meets_published_values) {
  const std::vector<std::array<double, 3>> rows{
      {1.5, 0, 0.04}, {1.5, 30, .0415226259758}, {1.5, 45, .050239911012236}, {1.5, 50, .0576629447039},
      {1.5, 60, .0891867128022}, {1.5, 70, .171042535367}, {1.5, 75, .25306056299}, {1.5, 80, .387704354691},
      {1.5, 85, .612799645265}, {1.5, 89, .90418494978}, {2.42, 0, .172394924934}, {2.42, 30, .173882970752},
      {2.42, 60, .21159756818}, {2.42, 75, .33062716725}, {2.42, 80, .433327611245}, {2.42, 85, .621621617891},
      {2.42, 89, .899692950188}, {1 / 1.5, 30, .0551901673}, {1 / 1.5, 40, .2452912043}, {1 / 1.5, 41.8, .8907719215},
      {1 / 2.42, 20, .1990661557}, {1 / 2.42, 24, .4288998439}, {1 / 2.42, 24.4, .8661287903}, {1 / 2.42, 30, 1}};
  for (const auto& [eta, angle, reflectance] : rows) {
    const Exact c = std::cos(angle * degree);
    EXPECT_NEAR(static_cast<double>(exact_reflectance(c, eta)), reflectance, 1e-10) << eta << " " << angle;
    EXPECT_NEAR(static_cast<double>(exact_reflectance(c, eta) + exact_transmittance(c, eta)), 1, 1e-15) << eta << " " << angle;
  }
  const std::vector<std::array<double, 4>> conductors{
      {1.2, 7.26, 0, .91659078745}, {1.2, 7.26, 45, .91256272038}, {1.2, 7.26, 80, .85363993287}, {1.2, 7.26, 89, .9593241089},
      {.155, 3.6, 0, .95662523327}, {.155, 3.6, 45, .95500685894}, {.155, 3.6, 80, .95718759359}, {.155, 3.6, 89, .99409246082},
      {.06, 3.59, 0, .98287145742}, {.06, 3.59, 45, .98219859264}, {.06, 3.59, 80, .98300889201}, {.06, 3.59, 89, .99770455046},
      {1, 1000, 0, .999996000016}, {1, 1000, 45, .99999575738}, {1, 1000, 80, .99998813567}, {1, 1000, 89, .99988575571}};
  for (const auto& [eta, k, angle, reflectance] : conductors)
    EXPECT_NEAR(static_cast<double>(exact_conductor(std::cos(angle * degree), eta, k)), reflectance, 1e-10) << k << " " << angle;
}

// 1e-6: some 16 roundings of quantities of order 1.
TEST(fresnel_test, dielectric_reflectance_obeys_fresnels_equations) {
  const std::vector<Row> rows = every_row();
  const std::vector<cl_float4> result = run_rows(rows);
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error = error_of(exact_reflectance, rows[i], result[i].s[0], false);
    ASSERT_LE(error, 1e-6) << describe(rows[i]) << " -> " << result[i].s[0];
    worst = std::max(worst, error);
  }
  record_extreme("X34", worst, 1e-6);
  record_extreme("X36", worst, 1e-6);
}

// Extreme X35: relative, because at grazing incidence 1 - reflectance has no digit left.
TEST(fresnel_test, dielectric_transmittance_keeps_its_digits_at_grazing_incidence) {
  const std::vector<Row> rows = every_row();
  const std::vector<cl_float4> result = run_rows(rows);
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error = error_of(exact_transmittance, rows[i], result[i].s[1], true);
    ASSERT_LE(error, 1e-6) << describe(rows[i]) << " -> " << result[i].s[1];
    worst = std::max(worst, error);
  }
  record_extreme("X35", worst, 1e-6);
}

TEST(fresnel_test, dielectric_loses_nothing) {
  const std::vector<Row> rows = every_row();
  const std::vector<cl_float4> result = run_rows(rows);
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double off = std::abs(static_cast<double>(result[i].s[0]) + result[i].s[1] - 1);
    ASSERT_LE(off, 1e-6) << describe(rows[i]);
    worst = std::max(worst, off);
    ASSERT_TRUE(result[i].s[0] >= 0 && result[i].s[1] >= 0) << describe(rows[i]);
  }
  record_extreme("X35", worst, 1e-6);
}

// Snell: cos_t^2 = 1 - sin_i^2 / eta^2. At most 8 roundings of terms of at most 1; below zero there is no transmitted direction.
TEST(fresnel_test, transmitted_cosine_obeys_snell) {
  const std::vector<Row> rows = every_row();
  const std::vector<cl_float4> result = run_rows(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Exact expected = exact_cos2_t(rows[i].cosine, rows[i].true_eta());
    if (result[i].s[1] == 0) {
      ASSERT_TRUE(rows[i].cosine == 0 || expected <= 8 * unit_roundoff) << describe(rows[i]);
      continue;
    }
    const Exact t = result[i].s[2];
    ASSERT_GE(t, 0) << describe(rows[i]);
    ASSERT_NEAR(static_cast<double>(t * t), static_cast<double>(expected), 8 * unit_roundoff) << describe(rows[i]);
  }
}

// By one float spacing on either side at least where the critical cosine allows: 8u of relative distance.
TEST(fresnel_test, dielectric_reflects_everything_beyond_the_critical_angle_and_only_there) {
  std::vector<Row> rows;
  for (float eta : {1.0001f, 1.33f, 1.5f, 2.42f, 1e3f})
    for (double factor : {0.0, 0.5, 0.999, 1 - 8 * unit_roundoff, 1 + 8 * unit_roundoff, 1.001}) {
      const Exact cosine = critical_cosine(1 / Exact(eta)) * factor;
      if (cosine < 1) rows.push_back({static_cast<float>(cosine), eta, 0});
    }
  const std::vector<cl_float4> result = run_rows(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool beyond = rows[i].cosine < critical_cosine(rows[i].true_eta());
    EXPECT_EQ(result[i].s[0] == 1.0f, beyond) << describe(rows[i]);
    EXPECT_EQ(result[i].s[1] == 0.0f, beyond) << describe(rows[i]);
  }
  record_law("X33");
}

TEST(fresnel_test, equal_indices_make_no_surface) {
  std::vector<Row> rows;
  for (cl_uint front : {0u, 1u})
    for (float cosine : cosines(1)) rows.push_back({cosine, 1.0f, front});
  const std::vector<cl_float4> result = run_rows(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(result[i].s[0], 0.0f) << describe(rows[i]);
    ASSERT_EQ(result[i].s[1], 1.0f) << describe(rows[i]);
    ASSERT_NEAR(result[i].s[2], rows[i].cosine, 2 * unit_roundoff) << describe(rows[i]);
  }
  record_law("X36");
}

// tan(angle) = eta: p-polarised light is not reflected, so the reflectance is half of s alone, ((eta^2 - 1)/(eta^2 + 1))^2 / 2.
TEST(fresnel_test, half_of_s_polarised_light_is_reflected_at_brewsters_angle) {
  std::vector<Row> rows;
  for (float eta : {1.33f, 1.5f, 2.42f})
    for (cl_uint front : {0u, 1u}) {
      const double relative = front ? eta : 1.0 / eta;
      rows.push_back({static_cast<float>(1 / std::hypot(1.0, relative)), eta, front});
    }
  const std::vector<cl_float4> result = run_rows(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double e2 = static_cast<double>(rows[i].eta) * rows[i].eta, s = (e2 - 1) / (e2 + 1);
    EXPECT_NEAR(result[i].s[0], s * s / 2, 1e-6) << describe(rows[i]);
  }
}

// Stokes: the way back through the surface has the same reflectance. 1e-6 for F, and the slope dF/dcos < 8 below 85 degrees
// outside times the rounding of the inner cosine.
TEST(fresnel_test, reflectance_is_the_same_on_the_way_back) {
  std::vector<Row> outside;
  for (float eta : {1.33f, 1.5f, 2.42f})
    for (double angle = 0; angle < 85; angle += 0.5) outside.push_back({static_cast<float>(std::cos(angle * degree)), eta, 1});
  const std::vector<cl_float4> there = run_rows(outside);
  std::vector<Row> inside;
  for (std::size_t i = 0; i < outside.size(); ++i) inside.push_back({there[i].s[2], outside[i].eta, 0});
  const std::vector<cl_float4> back = run_rows(inside);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const double slope = 200;  // of F over the inner cosine: at 85 degrees outside, dF/dcos_o (8) times dcos_o/dcos_i (< 25)
    EXPECT_NEAR(there[i].s[0], back[i].s[0], 2e-6 + slope * unit_roundoff) << describe(outside[i]);
  }
}

TEST(fresnel_test, interface_is_the_relative_index_its_square_and_the_square_less_one) {
  std::vector<float> eta;
  std::vector<cl_uint> front;
  for (float index : indices())
    for (cl_uint side : {0u, 1u}) eta.push_back(index), front.push_back(side);
  std::vector<cl_float4> result(eta.size());
  run("fresnel_test.cl", "interfaces", eta.size(), eta, front, out(result));
  for (std::size_t i = 0; i < eta.size(); ++i) {
    const Exact relative = Row{0, eta[i], front[i]}.true_eta(), less = (relative - 1) * (relative + 1);
    EXPECT_NEAR(result[i].s[0], static_cast<double>(relative), 1.01 * unit_roundoff * relative) << eta[i];
    EXPECT_NEAR(result[i].s[1], static_cast<double>(relative * relative), 4 * unit_roundoff * relative * relative) << eta[i];
    // Relative to itself: at eta = 1.000001 the square less one must not come from a subtraction of the rounded square.
    EXPECT_NEAR(result[i].s[2], static_cast<double>(less), static_cast<double>(6 * unit_roundoff * std::abs(less))) << eta[i];
  }
}

// Integral of F(c) 2c dc by 32 nodes in the cosine on the transmitted side of the denser medium, in which the integrand is
// analytic on both sides of the surface. Errors of 32 evaluations of 1e-6 with weights that sum to 1.
TEST(fresnel_test, cosine_averaged_reflectance_meets_published_values) {
  struct Average {
    float eta;
    double external, internal;
  };
  for (const Average& average : {Average{1.33f, .065930849299405, .4719491487927}, Average{1.5f, .091777959342351, .59634575970771},
                                 Average{1.8f, .13405444941832, .73273285475874},
                                 Average{2.42f, .21254079473884, .86553869181389}}) {
    std::vector<Row> rows;
    std::vector<double> weights;
    for (const Node& node : gauss_legendre(32, 0, 1)) {
      rows.push_back({static_cast<float>(node.x), average.eta, 1});
      weights.push_back(node.weight * 2 * node.x);
    }
    // Inside, c^2 = 1 - (1 - t^2)/eta^2 for the outer cosine t, and 2c dc = 2t dt / eta^2; all of the rest,
    // 1 - 1/eta^2, is reflected.
    const double e2 = static_cast<double>(average.eta) * average.eta;
    for (const Node& node : gauss_legendre(32, 0, 1)) {
      rows.push_back({static_cast<float>(std::sqrt(1 - (1 - node.x * node.x) / e2)), average.eta, 0});
      weights.push_back(node.weight * 2 * node.x / e2);
    }
    const std::vector<cl_float4> result = run_rows(rows);
    double external = 0, internal = 1 - 1 / e2;
    for (std::size_t i = 0; i < 32; ++i) external += weights[i] * result[i].s[0];
    for (std::size_t i = 32; i < 64; ++i) internal += weights[i] * result[i].s[0];
    EXPECT_NEAR(external, average.external, 1.2e-6) << average.eta;
    EXPECT_NEAR(internal, average.internal, 1.2e-6) << average.eta;
  }
}
