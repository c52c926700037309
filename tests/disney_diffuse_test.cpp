#include "diffuse_oracle.h"
#include "extremes.h"
#include "quadrature.h"
#include "scatter_cases.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846, degree = pi / 180;

struct Pairs {
  std::vector<cl_float4> wo, wi;
};

std::vector<cl_float4> evaluate(const Material& material, const Pairs& pairs) {
  std::vector<cl_float4> result(pairs.wi.size());
  run("disney_diffuse_test.cl", "evaluate", result.size(), std::vector(result.size(), material), pairs.wo, pairs.wi, out(result));
  return result;
}

Material white(double roughness) { return rough(MATERIAL_DISNEY, static_cast<float>(roughness), {1, 1, 1}); }

cl_float4 direction(double cosine, double phi) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {{static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)), static_cast<float>(cosine), 0}};
}

Pairs pairs() {
  Pairs list;
  for (double o : {1.0, 0.5, 1e-3, 1e-7})
    for (double i : {1.0, 0.5, 1e-3, 1e-7})
      for (double phi : {0.0, 1.0, pi}) list.wo.push_back(direction(o, 0.3)), list.wi.push_back(direction(i, 0.3 + phi));
  const std::size_t count = count_or_small(100000, 100);
  const std::vector<cl_float4> a = upper_directions(210, count), b = upper_directions(211, count + 17);
  for (std::size_t i = 0; i < count; ++i) list.wo.push_back(a[i]), list.wi.push_back(b[i + 17]);
  return list;
}

// Between a direction and the half vector, both of unit length.
Exact cosine_of_difference(const cl_float4& wo, const cl_float4& wi) {
  std::array<Exact, 3> o{wo.s[0], wo.s[1], wo.s[2]}, i{wi.s[0], wi.s[1], wi.s[2]}, h;
  const auto normalise = [](std::array<Exact, 3>& v) {
    const Exact length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (Exact& x : v) x /= length;
  };
  normalise(o), normalise(i);
  for (std::size_t k = 0; k < 3; ++k) h[k] = o[k] + i[k];
  normalise(h);
  return o[0] * h[0] + o[1] * h[1] + o[2] * h[2];
}

// Of degree 8 in the cosine and of degree 2 in the cosine of the azimuth: 8 nodes by 8 azimuths are exact up to rounding.
double directional_albedo(double roughness, double cosine) {
  Pairs list;
  std::vector<double> weights;
  for (const Node& node : gauss_legendre(8, 0, 1))
    for (int k = 0; k < 8; ++k) {
      list.wo.push_back(direction(cosine, 0));
      list.wi.push_back(direction(node.x, 2 * pi * k / 8));
      weights.push_back(node.weight * 2 * pi / 8);
    }
  const std::vector<cl_float4> value = evaluate(white(roughness), list);
  double albedo = 0;
  for (std::size_t i = 0; i < value.size(); ++i) albedo += weights[i] * value[i].s[0];
  return albedo;
}

// 20 roundings of values of at most 2 (extremes of the published quadrature: 7e-8 in float).
constexpr double albedo_tolerance = 2.5e-6;

}  // namespace

// Each of the two factors 1 + (F90 - 1) x^5 errs by one rounding, by 6 of x^5 and by 8u of F90 - 1 (a dot product of directions whose
// length errs by 2u, two more roundings).
TEST(disney_diffuse_test, value_is_the_formula_of_the_paper) {
  const Pairs list = pairs();
  for (float r : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const std::vector<cl_float4> value = evaluate(white(r), list);
    for (std::size_t k = 0; k < value.size(); ++k) {
      const Exact i = list.wi[k].s[2], o = list.wo[k].s[2], d = cosine_of_difference(list.wo[k], list.wi[k]);
      const Exact f = 2 * r * d * d - 0.5L, xi = std::pow(1 - i, 5), xo = std::pow(1 - o, 5), expected = exact_disney(i, o, d, r);
      const auto error = [&](Exact x) { return 1 + x * (6 * std::abs(f) + 8); };
      const Exact tolerance = (error(xi) * (1 + f * xo) + error(xo) * (1 + f * xi) + expected) * unit_roundoff;
      ASSERT_NEAR(value[k].s[3], static_cast<double>(expected), static_cast<double>(tolerance)) << r << " " << static_cast<double>(i);
      const Exact f_cos = expected * i / exact_pi;
      ASSERT_NEAR(value[k].s[0], static_cast<double>(f_cos), static_cast<double>(tolerance * i + 3 * unit_roundoff * f_cos));
    }
  }
}

TEST(disney_diffuse_test, channels_are_the_base_colour_times_one_factor) {
  const Pairs list = pairs();
  const std::vector<cl_float4> one = evaluate(white(0.7), list), coloured = evaluate(rough(MATERIAL_DISNEY, 0.7f), list);
  const float base[] = {0.8f, 0.5f, 0.25f};
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = base[k] * static_cast<double>(one[i].s[k]);
      ASSERT_NEAR(coloured[i].s[k], expected, 4 * unit_roundoff * expected);
    }
}

TEST(disney_diffuse_test, it_is_reciprocal) {
  const Pairs list = pairs(), swapped{list.wi, list.wo};
  for (float r : {0.0f, 0.5f, 1.0f}) {
    const std::vector<cl_float4> there = evaluate(white(r), list), back = evaluate(white(r), swapped);
    for (std::size_t i = 0; i < there.size(); ++i) ASSERT_NEAR(there[i].s[3], back[i].s[3], 2 * ulp(there[i].s[3]));
  }
}

// Retroreflection at grazing incidence: the half vector is undefined in the limit, the formula is not.
TEST(disney_diffuse_test, opposite_grazing_directions_are_finite) {
  const Pairs list{{direction(1e-7, 0), direction(1e-20, 0)}, {direction(1e-7, pi), direction(1e-20, pi)}};
  for (const cl_float4& value : evaluate(white(1.0), list)) ASSERT_NEAR(value.s[3], 0.25, 1e-5);  // F90 - 1 = -1/2 in both factors
}

TEST(disney_diffuse_test, nothing_is_scattered_to_the_other_side) {
  Pairs list = pairs();
  for (cl_float4& wi : list.wi) wi.s[2] = -wi.s[2];
  for (const cl_float4& value : evaluate(white(1.0), list))
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(value.s[k], 0.0f);
}

// Table computed with 30 digits.
TEST(disney_diffuse_test, directional_albedo_is_its_closed_form) {
  const std::vector<std::array<double, 6>> rows{{0, .976190476, .991071429, 1.00595238, 1.02083333, 1.03571429},
                                                {30, .976169409, .990668230, 1.00516746, 1.01966711, 1.03416717},
                                                {45, .975138390, .989920761, 1.00472397, 1.01954803, 1.03439292},
                                                {60, .960937500, .984478663, 1.00832016, 1.03246198, 1.05690414},
                                                {75, .867014816, .943462884, 1.02199144, 1.10260050, 1.18529004},
                                                {80, .788116149, .904992940, 1.02538775, 1.14930059, 1.27673144},
                                                {85, .666813487, .841763943, 1.02237020, 1.20863225, 1.40055011},
                                                {90, .488095238, .742435516, 1.00545635, 1.27715774, 1.55753968}};
  double worst = 0;
  for (const auto& row : rows)
    for (std::size_t k = 1; k < row.size(); ++k) {
      const double r = 0.25 * static_cast<double>(k - 1), m = row[0] == 90 ? 1e-9 : std::cos(row[0] * degree);
      EXPECT_NEAR(static_cast<double>(exact_disney_albedo(m, r)), row[k], 1e-8) << row[0] << " " << r;
      const double off = std::abs(directional_albedo(r, m) - row[k]);
      EXPECT_LE(off, albedo_tolerance) << row[0] << " " << r;
      worst = std::max(worst, off);
    }
  record_extreme("X40", worst, albedo_tolerance);
}

TEST(disney_diffuse_test, hemispherical_albedo_is_its_closed_form) {
  const double table[] = {.952947845805, .980343265779, 1.00817861867, 1.03645390448, 1.0651691232};
  for (std::size_t k = 0; k < 5; ++k) {
    const double r = 0.25 * static_cast<double>(k);
    EXPECT_NEAR(static_cast<double>(exact_disney_hemispherical_albedo(r)), table[k], 1e-11);
    double albedo = 0;
    for (const Node& node : gauss_legendre(8, 0, 1)) albedo += node.weight * 2 * node.x * directional_albedo(r, node.x);
    EXPECT_NEAR(albedo, table[k], albedo_tolerance) << r;
  }
}
