// The filter's table and its sampling against the closed forms of box, tent and truncated Gaussian.
#include "../host/filter.h"
#include "../host/scene.h"
#include "extremes.h"
#include "kernel.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Filter {
  FilterKind kind;
  double radius, stddev;
  std::vector<FilterEntry> table;
  // Error of the tabulated integral against the closed form. Box and tent: 4 roundings. The Gaussian with width h = 2 r / 512 is off by h^2
  // max|f''| / 12 per unit of length at most, over the length in which f'' has one sign (2 stddev): h^2 / (12 s^2) 0.8, doubled for
  // the normalisation.
  double tolerance() const {
    const double h = 2 * radius / 512;
    return 8 * unit_roundoff + (kind == FilterKind::gaussian ? h * h / (6 * stddev * stddev) : 0.0);
  }
};

std::vector<Filter> filters() {
  std::vector<Filter> all = {{FilterKind::box, 0.5, 0, {}}, {FilterKind::box, 1.7, 0, {}}, {FilterKind::tent, 1.0, 0, {}},
                             {FilterKind::tent, 2.5, 0, {}}, {FilterKind::gaussian, 2.0, 0.5, {}}, {FilterKind::gaussian, 1.0, 0.7, {}}};
  for (Filter& f : all) f.table = filter_table(f.kind, f.radius, f.stddev);
  return all;
}

// Integral of the filter from -radius to x, closed form.
double exact_cdf(const Filter& f, double x) {
  x = std::clamp(x, -f.radius, f.radius);
  if (f.kind == FilterKind::box) return (x + f.radius) / (2 * f.radius);
  if (f.kind == FilterKind::tent) {
    const double s = 1.0 - std::abs(x) / f.radius;
    return x < 0 ? 0.5 * s * s : 1.0 - 0.5 * s * s;
  }
  const double r = f.radius, root = f.stddev * std::sqrt(2.0), edge = std::exp(-r * r / (root * root));
  const auto primitive = [&](double at) { return 0.5 * std::sqrt(std::acos(-1.0)) * root * std::erf(at / root) - edge * at; };
  return (primitive(x) - primitive(-r)) / (primitive(r) - primitive(-r));
}

std::vector<float> apply(const char* kernel, const Filter& f, const std::vector<float>& x) {
  std::vector<float> result(x.size());
  run("filter_test.cl", kernel, x.size(), f.table, static_cast<cl_uint>(f.table.size()), static_cast<float>(f.radius), x, out(result));
  return result;
}

std::vector<float> sample(const Filter& f, float low, float high, const std::vector<float>& u) {
  std::vector<float> result(u.size());
  run("filter_test.cl", "sample", u.size(), f.table, static_cast<cl_uint>(f.table.size()), static_cast<float>(f.radius), low, high, u, out(result));
  return result;
}

std::vector<float> random_units(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> u(n);
  for (float& x : u) x = random.unit24();
  return u;
}

}  // namespace

TEST(filter_test, the_table_integrates_to_one_and_ends_at_one) {
  for (const Filter& f : filters()) {
    const double width = 2 * f.radius / static_cast<double>(f.table.size() - 1);
    double integral = 0.0;
    for (std::size_t i = 0; i + 1 < f.table.size(); ++i) {
      integral += 0.5 * width * (static_cast<double>(f.table[i].density) + f.table[i + 1].density);
      EXPECT_GE(f.table[i].density, 0.0f);
      EXPECT_LE(f.table[i].integral, f.table[i + 1].integral);
      EXPECT_NEAR(f.table[i + 1].integral, integral, 2 * unit_roundoff);
    }
    EXPECT_NEAR(integral, 1.0, 2 * unit_roundoff);  // every density is rounded once
    EXPECT_EQ(f.table.front().integral, 0.0f);
    EXPECT_EQ(f.table.back().integral, 1.0f);
  }
  record_law("X49");
}

// A search that began behind its place would return the wrong one; one that began far before it would be slow.
TEST(filter_test, the_search_begins_at_or_before_its_place_and_one_step_before_in_the_mean) {
  for (const Filter& f : filters()) {
    const std::size_t last = f.table.size() - 2;
    double steps = 0.0;
    const std::vector<float> c = random_units(200000, 3);
    for (const float x : c) {
      const float scaled = x * static_cast<float>(f.table.size() - 1);
      const std::size_t begin = f.table[std::min(static_cast<std::size_t>(scaled), last)].first;
      const auto above = std::upper_bound(f.table.begin(), f.table.begin() + static_cast<std::ptrdiff_t>(last) + 1, x,
                                          [](float value, const FilterEntry& entry) { return value < entry.integral; });
      const auto place = static_cast<std::size_t>(above - f.table.begin()) - 1;
      ASSERT_LE(begin, place) << x;
      steps += static_cast<double>(place - begin);
    }
    EXPECT_LE(steps / static_cast<double>(c.size()), 1.1) << static_cast<int>(f.kind);
  }
}

TEST(filter_test, cdf_is_the_integral_of_the_closed_form) {
  for (const Filter& f : filters()) {
    std::vector<float> x;
    for (int i = 0; i <= 4000; ++i) x.push_back(static_cast<float>(f.radius * (i / 2000.0 - 1.0)));
    const std::vector<float> c = apply("cdf", f, x);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(c[i], exact_cdf(f, x[i]), f.tolerance()) << static_cast<int>(f.kind) << " " << x[i];
    EXPECT_EQ(c.front(), 0.0f);
    EXPECT_NEAR(c.back(), 1.0f, f.tolerance());
  }
}

// Judged backwards, in the integral: forwards the inverse is ill-conditioned where the density vanishes.
TEST(filter_test, inverse_returns_the_place_whose_integral_was_asked_for) {
  for (const Filter& f : filters()) {
    std::vector<float> c = random_units(count_or_small(20000, 50), 1);
    c.insert(c.end(), {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f, 1.0f});
    const std::vector<float> x = apply("inverse", f, c);
    for (std::size_t i = 0; i < c.size(); ++i) {
      EXPECT_LE(std::abs(x[i]), static_cast<float>(f.radius));
      // Rounding x by u radius moves the integral by u radius times the density, at most 1 / stddev here.
      EXPECT_NEAR(exact_cdf(f, x[i]), c[i], f.tolerance() + 4 * unit_roundoff * f.radius / std::max(f.stddev, 0.4)) << static_cast<int>(f.kind);
    }
  }
}

TEST(filter_test, samples_are_distributed_as_the_closed_form) {
  for (const Filter& f : filters()) {
    const std::vector<float> u = random_units(count_or_small(1000000, 1000), 2);
    const int bins = small_inputs() ? 4 : 101;  // odd: no bin boundary in the symmetric centre
    const auto judge = [&](float low, float high) {
      std::vector<double> counts(bins), expected(bins);
      const double from = std::max(-f.radius, static_cast<double>(low)), to = std::min(f.radius, static_cast<double>(high));
      const double all = exact_cdf(f, to) - exact_cdf(f, from), n = static_cast<double>(u.size());
      // Bins of equal probability by bisection, each expected n / bins.
      std::vector<double> ends(bins + 1, to);
      for (int b = 0; b < bins; ++b) {
        double a = from, z = to;
        for (int k = 0; k < 60; ++k) (exact_cdf(f, 0.5 * (a + z)) - exact_cdf(f, from) < all * b / bins ? a : z) = 0.5 * (a + z);
        ends[b] = b == 0 ? from : a;
      }
      for (int b = 0; b < bins; ++b) expected[b] = n * (exact_cdf(f, ends[b + 1]) - exact_cdf(f, ends[b])) / all;
      for (const float x : sample(f, low, high, u)) {
        ASSERT_GE(x, from);
        ASSERT_LE(x, to);
        counts[std::clamp<std::ptrdiff_t>(std::upper_bound(ends.begin(), ends.end(), static_cast<double>(x)) - ends.begin() - 1, 0, bins - 1)] += 1;
      }
      EXPECT_GE(chi_square_test(counts, expected), false_alarm) << static_cast<int>(f.kind) << " " << f.radius << " [" << low << ", " << high << "]";
    };
    const auto r = static_cast<float>(f.radius);
    judge(-r, r);
    judge(-1e9f, 1e9f);
    judge(-0.5f, r);        // at the film's left edge
    judge(-10.0f, 0.5f);    // at its right edge
    judge(-0.5f, 0.5f);     // a film of one pixel
  }
}

TEST(filter_test, at_the_edge_of_the_film_no_sample_lies_outside) {
  for (const Filter& f : filters()) {
    const std::vector<float> u = {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f};
    for (const float x : sample(f, -0.5f, 0.5f, u)) EXPECT_LE(std::abs(x), 0.5f);
    const std::vector<float> x = sample(f, -0.25f, 1e9f, u);
    EXPECT_NEAR(x[0], -0.25f, 1e-5);  // and they reach it: density > 0.2 there, integral good to 3e-6
  }
}
