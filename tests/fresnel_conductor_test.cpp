// Reflection by metals; the kernels are those of fresnel_test.cl.
#include "extremes.h"
#include "fresnel_oracle.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair::test;

namespace {

struct Row {
  float cosine, eta, k;
};

std::vector<float> run_rows(const std::vector<Row>& rows) {
  std::vector<float> cosine, eta, k, reflectance(rows.size());
  for (const Row& row : rows) cosine.push_back(row.cosine), eta.push_back(row.eta), k.push_back(row.k);
  run("fresnel_test.cl", "conductor", rows.size(), cosine, eta, k, out(reflectance));
  return reflectance;
}

std::vector<float> cosines() {
  std::vector<float> list{0.0f, 1.0f, 1 - 0x1p-24f, 0.70710678f};
  for (int k = 1; k <= 20; ++k) list.push_back(static_cast<float>(std::pow(10.0, -k)));
  const int steps = static_cast<int>(count_or_small(512, 8));
  for (int k = 1; k < steps; ++k) list.push_back(static_cast<float>(k) / static_cast<float>(steps));
  return list;
}

}  // namespace

// Extreme X38: k^4 overflows from 4e9 on, and eta << k cancels. 1e-6: some 16 roundings of quantities of order 1.
TEST(fresnel_conductor_test, conductor_reflectance_obeys_fresnels_equations) {
  std::vector<Row> rows;
  for (float eta : {0.0f, 1e-3f, 0.06f, 0.155f, 0.2f, 0.6f, 0.72f, 0.9f, 1.0f, 1.0001f, 1.2f, 1.5f, 5.0f, 100.0f})
    for (float k : {1e-6f, 1e-3f, 0.1f, 0.5f, 1.0f, 3.59f, 3.6f, 7.26f, 10.0f, 1e3f, 1e9f, 4e9f, 1e10f, 1e19f})
      for (float cosine : cosines()) rows.push_back({cosine, eta, k});
  const std::vector<float> reflectance = run_rows(rows);
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double off = std::abs(reflectance[i] - static_cast<double>(exact_conductor(row.cosine, row.eta, row.k)));
    ASSERT_LE(off, 1e-6) << row.cosine << " " << row.eta << " " << row.k;
    worst = std::max(worst, off);
    ASSERT_LE(reflectance[i], 1.0f + 1e-6f) << row.cosine << " " << row.eta << " " << row.k;
  }
  record_extreme("X38", worst, 1e-6);
}

// Except within 1e-4 of the critical cosine of eta < 1, where the slope is not bounded.
TEST(fresnel_conductor_test, conductor_without_absorption_is_a_dielectric) {
  std::vector<Row> rows;
  for (float eta : {1.0f, 1.33f, 1.5f, 2.42f, 0.9f, 0.5f, 1 / 1.5f})
    for (float cosine : cosines())
      if (eta >= 1 || std::abs(cosine - critical_cosine(eta)) > 1e-4L) rows.push_back({cosine, eta, 0.0f});
  const std::vector<float> reflectance = run_rows(rows);
  for (std::size_t i = 0; i < rows.size(); ++i)
    ASSERT_NEAR(reflectance[i], static_cast<double>(exact_reflectance(rows[i].cosine, rows[i].eta)), 1e-6)
        << rows[i].cosine << " " << rows[i].eta;
}

// The limit of small eta and k, where the amplitudes become 0/0 at normal incidence: nothing can propagate inside.
TEST(fresnel_conductor_test, conductor_of_index_zero_reflects_everything) {
  std::vector<Row> rows;
  for (float cosine : cosines()) rows.push_back({cosine, 0.0f, 0.0f});
  for (float reflectance : run_rows(rows)) ASSERT_NEAR(reflectance, 1, 4 * unit_roundoff);
}

TEST(fresnel_conductor_test, channels_are_independent) {
  Random random(11);
  const std::size_t count = count_or_small(3000, 64);
  std::vector<float> cosine(count);
  std::vector<cl_float4> eta(count), k(count), rgb(count);
  std::vector<Row> single;
  for (std::size_t i = 0; i < count; ++i) {
    cosine[i] = static_cast<float>(random.unit());
    for (int channel = 0; channel < 3; ++channel) {
      eta[i].s[channel] = static_cast<float>(random.between(0.05, 3));
      k[i].s[channel] = static_cast<float>(random.between(0, 8));
      single.push_back({cosine[i], eta[i].s[channel], k[i].s[channel]});
    }
  }
  run("fresnel_test.cl", "conductor_rgb", count, cosine, eta, k, out(rgb));
  const std::vector<float> expected = run_rows(single);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t channel = 0; channel < 3; ++channel) ASSERT_EQ(rgb[i].s[channel], expected[3 * i + channel]);
}
