// The kernels in float against the same source in double (cl/precision.h), over random and adversarial inputs. How far apart
// they may be says running error analysis of the formula, written here a second time; that formula must be the one that the
// double twin computes, so a wrong constant, which both twins have, fails as well.
#include <cfloat>
#include <cstdio>
#include <functional>
#include <optional>

#include "kernel.h"
#include "running_error.h"
#include "scatter_cases.h"
#include "triangle_oracle.h"

using namespace oclair;
using namespace oclair::test;

namespace {

bool has_double() { return device().device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0; }

using Floats3 = std::vector<packed_float3>;

struct Twins {
  std::vector<float> single;
  std::vector<double> twin;
};

template <class... Arguments>
Twins run_twins(const char* kernel, std::size_t rows, std::size_t columns, const Arguments&... arguments) {
  Twins twins{std::vector<float>(rows * columns), std::vector<double>(rows * columns)};
  run_with({every_feature}, "twin_test.cl", kernel, rows, arguments..., out(twins.single));
  run_with({every_feature, 8, 64, 0, true}, "twin_test.cl", kernel, rows, arguments..., out(twins.twin));
  return twins;
}

// Absent: a branch that rounding decides lies within the error of what it asks for.
using Row = std::optional<std::vector<Rounded>>;

bool undecided(Rounded a, double threshold = 0) { return std::abs(a.value - threshold) <= a.error; }

void append(std::vector<Rounded>& row, const Rounded3& v) { row.insert(row.end(), {v.x, v.y, v.z}); }

// Judges each number of each row; at most `undecided_share` of the rows may be left out. The double twin and the formula
// here are both in double, each within 2^-29 of what float may be off, and their functions may take as many ulps: they are
// within 2^-27.
void judge(const Twins& twins, const std::vector<std::string>& columns, const std::function<Row(std::size_t)>& formula,
           double undecided_share) {
  const std::size_t n = columns.size(), rows = twins.single.size() / n;
  std::vector<double> worst(n), ulps(n), absolute(n);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    const Row row = formula(i);
    if (!row) {
      ++left_out;
      for (std::size_t c = 0; c < n; ++c)
        ASSERT_TRUE(std::isfinite(twins.single[i * n + c])) << columns[c] << " of row " << i;
      continue;
    }
    ASSERT_EQ(row->size(), n);
    for (std::size_t c = 0; c < n; ++c) {
      const Rounded& bound = (*row)[c];
      const double single = twins.single[i * n + c], twin = twins.twin[i * n + c];
      ASSERT_LE(std::abs(twin - bound.value), 0x1p-27 * bound.error)
          << columns[c] << " of row " << i << ": double " << twin << ", formula " << bound.value;
      const double error = std::abs(single - twin);
      ASSERT_LE(error, bound.error) << columns[c] << " of row " << i << ": float " << single << ", double " << twin;
      if (bound.error > 0) worst[c] = std::max(worst[c], error / bound.error);
      ulps[c] = std::max(ulps[c], error / ulp(twin));
      absolute[c] = std::max(absolute[c], error);
    }
  }
  EXPECT_LE(static_cast<double>(left_out), undecided_share * static_cast<double>(rows));
  for (std::size_t c = 0; c < n; ++c) {
    char text[128];
    std::snprintf(text, sizeof text, "%.3g ulps, absolute %.3g, %.2f of the bound", ulps[c], absolute[c], worst[c]);
    testing::Test::RecordProperty(columns[c], text);
    EXPECT_GT(absolute[c], 0) << columns[c] << ": both twins compute in float";
  }
}

std::size_t many() { return count_or_small(20000, 200); }

float narrow(double x) { return static_cast<float>(x); }
Rounded3 exact(const packed_float3& v) { return {v.x, v.y, v.z}; }
Rounded3 scaled(const packed_float3& v, Rounded s) { return exact(v) * s; }

const Rounded pi = constant(3.14159265358979324), inv_pi = constant(0.318309886183790672);

// 0, 1 - 2^-24, their neighbours, eighths and theirs, powers of two, then random ones: what the samplers give.
std::vector<float> unit_numbers(std::uint64_t seed, std::size_t count) {
  std::vector<float> list;
  for (int k = 0; k <= 8; ++k)
    for (int step = -2; step <= 2; ++step) {
      const double x = k / 8.0 + step * 0x1p-24;
      if (x >= 0 && x < 1) list.push_back(narrow(x));
    }
  for (int k = 2; k <= 24; ++k) list.push_back(std::ldexp(1.0f, -k));
  Random random(seed);
  while (list.size() < count) list.push_back(random.unit24());
  return list;
}

// Every x beside numbers in another order.
Floats3 squares(std::uint64_t seed, const std::function<double(Random&)>& third) {
  Random random(seed);
  const std::vector<float> u = unit_numbers(seed + 1, many());
  Floats3 list;
  for (std::size_t i = 0; i < u.size(); ++i)
    list.push_back({u[i], u[random.below(static_cast<std::uint32_t>(u.size()))], narrow(third(random))});
  for (float x : {u[0], u[1], u[60]})
    for (std::size_t i = 0; i < 60; ++i)
      list.push_back({x, u[i], narrow(third(random))}), list.push_back({u[i], x, narrow(third(random))});
  return list;
}

struct Circle {
  Rounded x, y;
};
Circle warp_circle(double u) {
  const double quarter = std::rint(4 * u);
  const Rounded r = u - quarter / 4, r2 = r * r;  // exact: a multiple of the ulp of u, and no longer than it
  const Rounded s = r * fma(fma(fma(-75.393616f, r2, 81.592354f), r2, -41.341663f), r2, 6.2831855f);
  const Rounded c = fma(fma(fma(fma(59.20282f, r2, -85.4423f), r2, 64.93931f), r2, -19.739208f), r2, 1.0);
  const int k = static_cast<int>(quarter) & 3;
  const Circle swapped = k & 1 ? Circle{-s, c} : Circle{c, s};
  return k & 2 ? Circle{-swapped.x, -swapped.y} : swapped;
}

Rounded3 warp_cone(double u, double v, Rounded one_minus_cos) {
  const Rounded h = u * one_minus_cos, radius = sqrt(h * (2 - h));
  const Circle circle = warp_circle(v);
  return {radius * circle.x, radius * circle.y, 1 - h};
}
Rounded warp_cone_pdf(Rounded one_minus_cos) { return 1 / (2 * pi * one_minus_cos); }

Circle warp_triangle(double x, double y) {
  return y > x ? Circle{0.5 * x, Rounded(y) - 0.5 * x} : Circle{Rounded(x) - 0.5 * y, 0.5 * y};
}

}  // namespace

TEST(twin_test, warps_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  const Floats3 points =
      squares(900, [](Random& random) { return random.below(8) == 0 ? 2.0 : 2 * random.log_between(1e-12, 1.0); });
  judge(
      run_twins("warps", points.size(), 12, points),
      {"circle x", "circle y", "hemisphere x", "hemisphere y", "hemisphere z", "cone x", "cone y", "cone z", "cone pdf",
       "triangle b1", "triangle b2", "hemisphere pdf"},
      [&](std::size_t i) -> Row {
        const auto [u, v, w] = points[i];
        const Circle circle = warp_circle(v), triangle = warp_triangle(u, v);
        const Rounded radius = sqrt(Rounded(u));
        std::vector<Rounded> row{circle.x, circle.y, radius * circle.x, radius * circle.y, sqrt(Rounded(1) - u)};
        append(row, warp_cone(u, v, w));
        row.insert(row.end(), {warp_cone_pdf(w), triangle.x, triangle.y, u * inv_pi});
        return row;
      },
      0);
}

namespace {

struct InterfaceBound {
  Rounded eta, eta2, eta2_minus_one;
};

InterfaceBound interface_from_eta(float eta, bool front) {
  const Rounded eta2 = Rounded(eta) * eta, e = (Rounded(eta) - 1) * (Rounded(eta) + 1);
  if (front) return {eta, eta2, e};
  return {1 / Rounded(eta), 1 / eta2, -e / eta2};
}

Rounded sine2(Rounded c) { return (1 - c) * (1 + c); }

Row dielectric(const packed_float3& wo, float eta, bool front) {
  const Rounded c = std::min(wo.z, 1.0f);
  const InterfaceBound i = interface_from_eta(eta, front);
  Rounded reflectance = 1, transmittance = 0, cos_t = 0;
  if (eta == 1.0f) {
    reflectance = 0, transmittance = 1, cos_t = c;
  } else {
    if (undecided(i.eta2, 0.5)) return {};
    const Rounded sin2 = sine2(c), g2 = i.eta2.value < 0.5 ? i.eta2 - sin2 : fma(c, c, i.eta2_minus_one);
    if (undecided(g2)) return {};
    if (g2.value > 0) {
      const Rounded g = sqrt(g2), p = c + g, q = fma(i.eta2, c, g), p2 = 1 / (p * p), q2 = 1 / (q * q);
      const Rounded rs = i.eta2_minus_one * p2, rp = i.eta2_minus_one * fma(i.eta2 * c, c, -sin2) * q2;
      reflectance = 0.5 * fma(rs, rs, rp * rp);
      transmittance = 2 * c * g * fma(i.eta2, q2, p2);
      cos_t = g / i.eta;
    }
  }
  std::vector<Rounded> row{reflectance, transmittance, cos_t};
  const Rounded inverse = 1 / i.eta;
  append(row, cos_t.value > 0 ? renormalize({-(wo.x * inverse), -(wo.y * inverse), -cos_t}) : exact(wo));
  return row;
}

// Cosines: grazing down to 10^-20, upright, around a critical angle, random.
std::vector<double> cosines(Random& random, double eta, std::size_t count) {
  std::vector<double> list{1, 1 - 0x1p-24, 1 - 1e-6};
  for (int k = 1; k <= 20; ++k) list.push_back(std::pow(10.0, -k));
  if (eta < 1)
    for (int k = -12; k <= 12; ++k)
      list.push_back(std::min(std::sqrt(1 - eta * eta) * (1 + k * std::abs(k) * 0x1p-20), 1.0));
  while (list.size() < count) list.push_back(random.unit());
  return list;
}

packed_float3 inclined(double cosine, double azimuth) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {narrow(sine * std::cos(azimuth)), narrow(sine * std::sin(azimuth)), narrow(cosine)};
}

}  // namespace

TEST(twin_test, dielectrics_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(910);
  Floats3 wo;
  std::vector<float> eta;
  std::vector<cl_uint> front;
  for (float index : {1.0f, 1.000001f, 1.0001f, 1.33f, 1.5f, 2.42f, 1e3f, 1 / 1.000001f, 1 / 1.0001f, 1 / 1.33f, 1 / 1.5f,
                      1 / 2.42f, 1e-3f})
    for (cl_uint side : {1u, 0u})
      for (double c : cosines(random, side ? index : 1 / static_cast<double>(index), many() / 26 + 40)) {
        wo.push_back(inclined(c, random.between(0, 7)));
        eta.push_back(index);
        front.push_back(side);
      }
  judge(
      run_twins("dielectrics", wo.size(), 6, wo, eta, front),
      {"reflectance", "transmittance", "transmitted cosine", "refracted x", "refracted y", "refracted z"},
      [&](std::size_t i) { return dielectric(wo[i], eta[i], front[i] != 0); }, 0.02);
}

TEST(twin_test, conductors_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(920);
  Floats3 arguments;
  for (float eta : {0.05f, 0.2f, 0.69f, 0.71f, 0.999999f, 1.0f, 1.000001f, 1.5f, 10.0f, 1e3f})
    for (float k : {0.0f, 1e-6f, 0.1f, 1.0f, 3.6f, 1e3f, 1e10f})
      for (double c : cosines(random, 2, many() / 70 + 30)) arguments.push_back({narrow(c), eta, k});
  judge(
      run_twins("conductors", arguments.size(), 2, arguments), {"reflectance", "reflectance at normal incidence"},
      [&](std::size_t i) -> Row {
        const Rounded c = arguments[i].x, eta = arguments[i].y, k = arguments[i].z;
        const Rounded sin2 = sine2(c), product = eta * k;
        const Rounded difference =
            eta.value < 0.7f ? fma(eta - k, eta + k, -sin2) : fma(c, c, fma(-k, k, (eta - 1) * (eta + 1)));
        if (undecided(difference) && !(difference.value == 0 && k.value == 0)) return {};
        const Rounded larger = sqrt(0.5 * (hypot(difference, 2 * product) + fabs(difference)));
        if (!(larger.value > larger.error)) return {};
        const Rounded smaller = product / larger;
        const Rounded a = difference.value >= 0 ? larger : smaller, b = difference.value >= 0 ? smaller : larger;
        const Rounded rs = fma(a - c, a - c, b * b) / fma(a + c, a + c, b * b);
        const Rounded up = fma(a, c, -sin2), down = fma(a, c, sin2), bc = b * c;
        const Rounded below = fma(down, down, bc * bc);
        const Rounded rp = below.value > 0 ? rs * (fma(up, up, bc * bc) / below) : rs;
        const Rounded ratio = hypot(eta - 1, k) / hypot(eta + 1, k);
        return std::vector<Rounded>{0.5 * (rs + rp), ratio * ratio};
      },
      0.02);
}

namespace {

Rounded diffuse_eval(Rounded factor, const packed_float3& wi) { return factor * (wi.z * inv_pi); }

struct Slopes {
  Rounded sin_o, sin_i, sum, cos_azimuth, larger_cosine, sin_alpha, tan_beta;
};

Slopes oren_nayar_angles(const packed_float3& wo, const packed_float3& wi) {
  Slopes s;
  s.sin_o = length({wo.x, wo.y, 0}), s.sin_i = length({wi.x, wi.y, 0});
  s.sum = dot({wo.x, wo.y, 0}, {wi.x, wi.y, 0});
  const Rounded product = s.sin_o * s.sin_i;
  if (product.value >= FLT_MIN) s.cos_azimuth = fmin(fmax(s.sum / product, -1), 1);
  s.larger_cosine = std::max(wo.z, wi.z);
  s.sin_alpha = fmax(s.sin_o, s.sin_i);
  s.tan_beta = fmin(s.sin_o, s.sin_i) / s.larger_cosine;
  return s;
}

Rounded oren_nayar_fast(const Material& m, const packed_float3& wo, const packed_float3& wi) {
  const Rounded sigma2 = Rounded(m.roughness) * m.roughness;
  const Rounded a = 1 - 0.5 * sigma2 / (sigma2 + constant(0.33)), b = constant(0.45) * sigma2 / (sigma2 + constant(0.09));
  const Slopes s = oren_nayar_angles(wo, wi);
  return m.reflectance.x * fma(b, fmax(s.sum, 0) / s.larger_cosine, a);
}

std::optional<Rounded> oren_nayar_full(const Material& m, const packed_float3& wo, const packed_float3& wi) {
  const Rounded sigma2 = Rounded(m.roughness) * m.roughness;
  const Slopes s = oren_nayar_angles(wo, wi);
  if (undecided(s.cos_azimuth) && s.cos_azimuth.error > 0) return {};
  const Rounded theta_o = atan2(s.sin_o, wo.z), theta_i = atan2(s.sin_i, wi.z);
  const Rounded alpha = fmax(theta_o, theta_i), beta = fmin(theta_o, theta_i), beta2 = 2 * inv_pi * beta;
  const Rounded rough = sigma2 / (sigma2 + constant(0.09)), c1 = 1 - 0.5 * sigma2 / (sigma2 + constant(0.33));
  const Rounded c2 = constant(0.45) * rough * (s.cos_azimuth.value >= 0 ? s.sin_alpha : s.sin_alpha - beta2 * beta2 * beta2);
  const Rounded ab = 4 * inv_pi * inv_pi * alpha * beta, c3 = 0.125 * rough * ab * ab;
  const Rounded tan_half = (s.sin_o + s.sin_i) / (Rounded(wo.z) + wi.z);
  const Rounded single = c1 + s.cos_azimuth * c2 * s.tan_beta + (1 - fabs(s.cos_azimuth)) * c3 * tan_half;
  const Rounded twofold = constant(0.17) * sigma2 / (sigma2 + constant(0.13)) * (1 - s.cos_azimuth * beta2 * beta2);
  const Rounded albedo = m.reflectance.x;
  return fmax(albedo * single + albedo * albedo * twofold, 0);
}

Rounded disney_diffuse(const Material& m, const packed_float3& wo, const packed_float3& wi) {
  const Rounded f90 = fma(m.roughness, 1 + dot(exact(wi), exact(wo)), -0.5);
  const Rounded i = fmax(Rounded(1) - wi.z, 0), o = fmax(Rounded(1) - wo.z, 0), i2 = i * i, o2 = o * o;
  return m.reflectance.x * (fma(f90, i2 * i2 * i, 1) * fma(f90, o2 * o2 * o, 1));
}

}  // namespace

TEST(twin_test, diffuse_models_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(930);
  Floats3 wo, wi;
  std::vector<Material> materials;
  for (float roughness : {0.0f, 1e-4f, 0.01f, 0.3f, 0.7f, 1.0f}) {
    const std::vector<double> in = cosines(random, 2, many() / 6);
    for (double c : in)
      for (double azimuth : {0.0, 1.0, 3.1, 2 * c}) {
        const double first = random.between(0, 7);
        wi.push_back(inclined(c, first + azimuth));
        wo.push_back(inclined(in[random.below(static_cast<std::uint32_t>(in.size()))], first));
        materials.push_back(rough(MATERIAL_OREN_NAYAR, roughness, {narrow(random.unit()), 0, 0}));
      }
  }
  judge(
      run_twins("diffuses", wo.size(), 4, materials, wo, wi), {"Lambert", "Oren-Nayar", "Oren-Nayar qualitative", "Disney"},
      [&](std::size_t i) -> Row {
        const std::optional<Rounded> full = oren_nayar_full(materials[i], wo[i], wi[i]);
        if (!full) return {};
        return std::vector<Rounded>{diffuse_eval(materials[i].reflectance.x, wi[i]), diffuse_eval(*full, wi[i]),
                                    diffuse_eval(oren_nayar_fast(materials[i], wo[i], wi[i]), wi[i]),
                                    diffuse_eval(disney_diffuse(materials[i], wo[i], wi[i]), wi[i])};
      },
      0.02);
}

TEST(twin_test, multiple_importance_weights_are_as_exact_as_their_formula_lets_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(940);
  std::vector<cl_float2> densities;
  for (double x : {1e-30, 1e-20, 1e-10, 1.0, 1.9e19, 1e30, 1e38})
    for (double y : {1e-30, 1e-20, 1e-10, 1.0, 1.9e19, 1e30, 1e38}) densities.push_back({{narrow(x), narrow(y)}});
  for (std::size_t i = 0; i < many(); ++i) {
    const double a = random.log_between(1e-25, 1e25);
    densities.push_back({{narrow(a), narrow(a * random.log_between(1e-3, 1e3))}});
  }
  judge(
      run_twins("powers", densities.size(), 1, densities), {"weight"},
      [&](std::size_t i) -> Row {
        const float a = densities[i].s[0], b = densities[i].s[1];
        const Rounded r = Rounded(std::min(a, b)) / std::max(a, b), down = fma(r, r, 1);
        return std::vector<Rounded>{a > b ? 1 / down : a == b ? Rounded(0.5) : r * r / down};
      },
      0);
}

// The bound is that of the triangle tests (triangle_oracle.h). Where rounding decides between hit and miss, the row is left
// out.
TEST(twin_test, triangles_are_as_exact_as_their_formula_lets_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(950);
  std::vector<TriangleBlock<8>> blocks(many());
  Floats3 origins, directions;
  std::vector<Corners> corners;
  for (auto& block : blocks) {
    const double size = random.log_between(1e-6, 1), thin = random.below(4) == 0 ? random.log_between(1e-5, 1) : 1;
    const glm::dvec3 v0 = random.in_cube(0.9 - 0.8 * size), along = size * 0.4 * random.direction(),
                     across = thin * size * 0.4 * random.direction();
    const glm::dvec3 target = v0 + random.unit() * along + random.unit() * across;  // half of them beyond the third edge
    corners.push_back({packed(v0), packed(v0 + along), packed(v0 + across)});
    origins.push_back(packed(random.in_cube()));
    directions.push_back(packed(glm::normalize(target - unpacked(origins.back()))));
    for (int lane = 0; lane < 8; ++lane) {
      block.primitive[lane] = 0;
      for (std::size_t v = 0; v < 3; ++v) {
        block.vertex[v][0][lane] = corners.back()[v].x;
        block.vertex[v][1][lane] = corners.back()[v].y;
        block.vertex[v][2][lane] = corners.back()[v].z;
      }
    }
  }
  judge(
      run_twins("triangles", blocks.size(), 3, blocks, origins, directions), {"t", "b1", "b2"},
      [&](std::size_t i) -> Row {
        const Ray ray{origins[i], 1e30f, directions[i], NONE, NONE, 0.0f, 0};
        const auto oracle = exact_intersection<double>(ray, corners[i]);
        if (oracle.certain_miss) return std::vector<Rounded>{-1, 0, 0};
        if (!oracle.certain_hit) return {};
        return std::vector<Rounded>{{oracle.t, oracle.t_error}, {oracle.b1, oracle.b_error}, {oracle.b2, oracle.b_error}};
      },
      0.25);
}

namespace {

Rounded3 triangle_normal(const packed_float3& edge1, const packed_float3& edge2) {
  const Rounded3 n = cross_exact(exact(edge1), exact(edge2));
  return normalize(n * (1 / max_component(fabs(n))));
}

}  // namespace

// Slivers whose edges are parallel but for 10^-6.
TEST(twin_test, triangle_normals_are_as_exact_as_their_formula_lets_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(955);
  Floats3 edge1, edge2;
  for (std::size_t i = 0; i < many(); ++i) {
    const double size = random.log_between(1e-12, 1);
    const glm::dvec3 along = size * random.direction();
    edge1.push_back(packed(along));
    edge2.push_back(packed(random.log_between(0.01, 1) * (along + random.log_between(1e-6, 1) * size * random.direction())));
  }
  judge(
      run_twins("normals", edge1.size(), 3, edge1, edge2), {"normal x", "normal y", "normal z"},
      [&](std::size_t i) -> Row {
        std::vector<Rounded> row;
        append(row, triangle_normal(edge1[i], edge2[i]));
        return row;
      },
      0);
}

namespace {

// Ends a light sample at `point` of an area light; see light_from_area.
Row light_from_area(const Light& light, float area, const packed_float3& from, const Rounded3& point, Rounded error,
                    const Rounded3& normal) {
  const Rounded3 d = point - exact(from);
  const Rounded distance2 = dot(d, d);
  const Rounded3 direction = d * rsqrt(distance2);
  const Rounded cosine = -dot(normal, direction);
  if (undecided(cosine)) return {};
  const bool seen = cosine.value > 0;
  const Rounded offset = (fabs(normal.x) + fabs(normal.y) + fabs(normal.z)) * error;
  std::vector<Rounded> row;
  append(row, direction);
  row.push_back(length(point + normal * (seen ? offset : -offset) - exact(from)));
  row.push_back(seen ? light.radiance.x * (cosine * area / (distance2 * light.probability)) : 0);
  row.push_back(seen ? Rounded(light.probability) / area * distance2 / cosine : 0);
  return row;
}

Row triangle_light(const Light& light, const packed_float3& from, double u, double v) {
  const Circle b = warp_triangle(u, v);
  const Rounded3 p1 = scaled(light.edge1, b.x), p2 = scaled(light.edge2, b.y), v0 = exact(light.position);
  const Rounded error = double{8.00001f} * 0x1p-24 * max_component(fabs(v0) + fabs(p1) + fabs(p2));
  return light_from_area(light, light.area, from, v0 + p1 + p2, error, triangle_normal(light.edge1, light.edge2));
}

Row sphere_light(const Light& light, const Quadric& sphere, const packed_float3& from, double u, double v) {
  const Rounded3 axis = exact(sphere.axis_x), d = exact(sphere.center) - exact(from);
  const Rounded radius2 = 1 / dot(axis, axis), distance2 = dot(d, d);
  if (undecided(distance2 - 1.0001 * radius2) || distance2.value < 1.0001 * radius2.value) return {};
  const Rounded sin2 = radius2 / distance2, one_minus_cos = sin2 / (1 + sqrt(fmax(0, 1 - sin2)));
  const Rounded3 cone = warp_cone(u, v, one_minus_cos), z = d * rsqrt(distance2);
  if (undecided(z.z)) return {};
  std::vector<Rounded> row;
  append(row, frame_to_world(frame_from_normal(z), cone));
  const Rounded across2 = dot({cone.x, cone.y, 0}, {cone.x, cone.y, 0});
  row.push_back(cone.z * sqrt(distance2) - sqrt(fmax(0, radius2 - distance2 * across2)));
  const Rounded pdf = light.probability * warp_cone_pdf(one_minus_cos);
  row.push_back(light.radiance.x / pdf);
  row.push_back(pdf);
  return row;
}

Row point_light(const Light& light, const packed_float3& from) {
  const Rounded3 d = exact(light.position) - exact(from);
  const Rounded distance2 = dot(d, d), distance = sqrt(distance2);
  const Rounded3 direction{d.x / distance, d.y / distance, d.z / distance};
  Rounded weight = Rounded(light.radiance.x) / light.probability / distance2;
  if (light.kind == LIGHT_SPOT) {
    const Rounded3 axis = exact(light.edge1), away = -direction;
    const Rounded3 across{axis.y * away.z - axis.z * away.y, axis.z * away.x - axis.x * away.z,
                          axis.x * away.y - axis.y * away.x};
    const Rounded angle = atan2(sqrt(dot(across, across)), dot(axis, away)), cutoff = light.edge2.x, beam = light.edge2.y;
    if (undecided(angle, cutoff.value) || undecided(angle, beam.value)) return {};
    if (angle.value > beam.value)
      weight = weight * (angle.value < cutoff.value ? (cutoff - angle) / (cutoff - beam) : Rounded(0));
  }
  std::vector<Rounded> row;
  append(row, direction);
  row.insert(row.end(), {distance, weight, 0});
  return row;
}

Light random_light(Random& random, LightKind kind) {
  Light light{};
  light.kind = kind;
  light.radiance = {narrow(random.log_between(1e-6, 1e6)), 0, 0};
  light.probability = narrow(random.log_between(1e-9, 1));
  light.position = packed(random.in_cube());
  return light;
}

// Points at a distance between 10^-5 and 1 of the light's size or place, in the scene.
packed_float3 point_near(Random& random, const packed_float3& place, double least) {
  return packed(glm::clamp(unpacked(place) + random.log_between(least, 1.0) * random.direction(), -1.0, 1.0));
}

void judge_lights(const std::vector<Light>& lights, const std::vector<Quadric>& quadrics, const Floats3& from,
                  std::uint64_t seed, bool has_density, double undecided_share,
                  const std::function<Row(std::size_t, double, double)>& formula) {
  Random random(seed);
  const std::vector<float> u = unit_numbers(seed + 1, lights.size());
  std::vector<cl_ulong> bits;
  std::vector<std::array<double, 2>> squares;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double x = u[i], y = u[random.below(static_cast<std::uint32_t>(u.size()))];
    squares.push_back({x, y});
    bits.push_back(static_cast<cl_ulong>(x * 0x1p24) << 40 | static_cast<cl_ulong>(y * 0x1p24) << 8);
  }
  const Twins all = run_twins("lights", lights.size(), 6, lights, quadrics, from, bits);
  if (has_density) {
    judge(
        all, {"direction x", "direction y", "direction z", "distance", "weight", "pdf"},
        [&](std::size_t i) { return formula(i, squares[i][0], squares[i][1]); }, undecided_share);
    return;
  }
  Twins without;  // a delta: its density is exactly 0
  for (std::size_t i = 0; i < all.single.size(); ++i) {
    if (i % 6 != 5)
      without.single.push_back(all.single[i]), without.twin.push_back(all.twin[i]);
    else
      ASSERT_EQ(all.single[i], 0.0f);
  }
  judge(
      without, {"direction x", "direction y", "direction z", "distance", "weight"},
      [&](std::size_t i) {
        Row row = formula(i, 0, 0);
        if (row) row->pop_back();
        return row;
      },
      undecided_share);
}

}  // namespace

TEST(twin_test, triangle_lights_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(960);
  std::vector<Light> lights;
  Floats3 from;
  for (std::size_t i = 0; i < many(); ++i) {
    Light light = random_light(random, LIGHT_TRIANGLE);
    const double size = random.log_between(1e-4, 0.5), thin = random.below(4) == 0 ? random.log_between(1e-4, 1) : 1;
    light.edge1 = packed(size * random.direction());
    light.edge2 = packed(thin * size * random.direction());
    light.area = narrow(0.5 * glm::length(glm::cross(unpacked(light.edge1), unpacked(light.edge2))));
    from.push_back(point_near(random, light.position, 1e-3));
    lights.push_back(light);
  }
  judge_lights(lights, {Quadric{}}, from, 961, true, 0.01,
               [&](std::size_t i, double u, double v) { return triangle_light(lights[i], from[i], u, v); });
}

TEST(twin_test, sphere_lights_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(970);
  std::vector<Light> lights;
  std::vector<Quadric> quadrics;
  Floats3 from;
  for (std::size_t i = 0; i < many(); ++i) {
    Light light = random_light(random, LIGHT_QUADRIC);
    light.primitive = QUADRIC_BIT | static_cast<cl_uint>(i);
    const double radius = random.log_between(1e-5, 0.5);
    Quadric sphere{};
    sphere.kind = QUADRIC_SPHERE;
    sphere.center = light.position;
    sphere.flip = 1;
    sphere.axis_x = {narrow(1 / radius), 0, 0}, sphere.axis_y = {0, narrow(1 / radius), 0},
    sphere.axis_z = {0, 0, narrow(1 / radius)};
    from.push_back(packed(unpacked(light.position) + radius * (1 + random.log_between(1e-3, 1e3)) * random.direction()));
    lights.push_back(light), quadrics.push_back(sphere);
  }
  judge_lights(lights, quadrics, from, 971, true, 0.02,
               [&](std::size_t i, double u, double v) { return sphere_light(lights[i], quadrics[i], from[i], u, v); });
}

TEST(twin_test, point_and_spot_lights_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(980);
  std::vector<Light> lights;
  Floats3 from;
  for (std::size_t i = 0; i < many(); ++i) {
    Light light = random_light(random, i % 2 ? LIGHT_SPOT : LIGHT_POINT);
    const double cutoff = random.log_between(1e-3, 1.5);
    const glm::dvec3 axis = random.direction();
    light.edge1 = packed(axis);
    light.edge2 = {narrow(cutoff), narrow(cutoff * random.unit()), 0};
    const glm::dvec3 lit = glm::normalize(axis + std::tan(cutoff) * random.unit() * random.direction());
    from.push_back(i % 2 ? packed(unpacked(light.position) + random.log_between(1e-3, 1) * lit)
                         : point_near(random, light.position, 1e-5));
    lights.push_back(light);
  }
  judge_lights(lights, {Quadric{}}, from, 981, false, 0.02,
               [&](std::size_t i, double, double) { return point_light(lights[i], from[i]); });
}

// From within the scene: what moves a ray into it is not met.
TEST(twin_test, cameras_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(990);
  const std::vector<float> u = unit_numbers(991, many());
  std::vector<Camera> cameras;
  std::vector<cl_float4> points;
  for (std::size_t i = 0; i < many(); ++i) {
    const glm::dvec3 axis = random.direction(), right = glm::normalize(glm::cross(axis, random.direction())),
                     up = glm::cross(axis, right);
    const double pixels = random.log_between(1, 1e5), step = 2 * random.log_between(1e-3, 2) / pixels;
    Camera camera{};
    camera.origin = packed(random.in_cube(0.5));
    camera.near_clip = narrow(random.log_between(1e-4, 0.1)), camera.far_clip = narrow(random.log_between(1, 1e4));
    camera.corner = packed(axis - 0.5 * pixels * step * (right + up));
    camera.step_x = packed(step * right), camera.step_y = packed(step * up);
    camera.axis = packed(axis);
    camera.aperture_radius = i % 2 ? narrow(random.log_between(1e-4, 0.1)) : 0;
    camera.focus_distance = narrow(random.log_between(0.1, 10));
    cameras.push_back(camera);
    points.push_back({{narrow(random.unit() * pixels), narrow(random.unit() * pixels), u[i],
                       u[random.below(static_cast<std::uint32_t>(u.size()))]}});
  }
  judge(
      run_twins("cameras", cameras.size(), 7, cameras, points),
      {"origin x", "origin y", "origin z", "direction x", "direction y", "direction z", "t_max"},
      [&](std::size_t i) -> Row {
        const Camera& camera = cameras[i];
        const auto& [x, y, lens_x, lens_y] = points[i].s;
        Rounded3 along = exact(camera.corner) + scaled(camera.step_x, x) + scaled(camera.step_y, y),
                 origin = exact(camera.origin);
        if (camera.aperture_radius > 0) {
          const Circle circle = warp_circle(lens_y);
          const Rounded radius = sqrt(Rounded(lens_x)), focus = camera.focus_distance;
          const Rounded3 on_lens = normalize(exact(camera.step_x)) * (camera.aperture_radius * (radius * circle.x)) +
                                   normalize(exact(camera.step_y)) * (camera.aperture_radius * (radius * circle.y));
          origin = origin + on_lens;
          along = along - Rounded3{on_lens.x / focus, on_lens.y / focus, on_lens.z / focus};
        }
        const Rounded stretch = length(along), near_t = camera.near_clip * stretch;
        const Rounded3 d{along.x / stretch, along.y / stretch, along.z / stretch};
        std::vector<Rounded> row{fma(d.x, near_t, origin.x), fma(d.y, near_t, origin.y), fma(d.z, near_t, origin.z)};
        append(row, d);
        row.push_back((Rounded(camera.far_clip) - camera.near_clip) * stretch);
        return row;
      },
      0);
}

namespace {

struct Relief {
  packed_float3 color, normal, dp_du, dp_dv;
  cl_float2 slope;
};

// A derivative of the displaced surface; absent: too short to have a direction.
Rounded3 bump_tangent(const Rounded3& n, const Rounded3& derivative, double slope) {
  const Rounded3 along = derivative - n * dot(n, derivative);
  const Rounded scale = 1 / fmax(max_component(fabs(along)), std::abs(slope));
  return along * scale + n * (slope * scale);
}

Row relief(const Relief& r) {
  std::vector<Rounded> row;
  const Rounded3 decoded{2 * Rounded(r.color.x) - 1, 2 * Rounded(r.color.y) - 1, 2 * Rounded(r.color.z) - 1};
  const Rounded length2 = dot(decoded, decoded);
  if (undecided(length2, 1e-4) || undecided(decoded.z)) return {};
  const bool says = length2.value > 1e-4 && decoded.z.value > 0;
  append(row, says ? decoded * rsqrt(length2) : Rounded3{0, 0, 1});

  const Rounded3 z = exact(r.normal), du = exact(r.dp_du);
  const Rounded3 u = du * (1 / max_component(fabs(du)));
  Rounded3 x = u - z * dot(z, u);
  const Rounded across2 = dot(x, x);
  if (undecided(across2, 1e-6) || across2.value < 1e-6) return {};
  x = x * rsqrt(across2);
  x = x - z * dot(z, x);
  x = x * rsqrt(dot(x, x));
  append(row, x);
  append(row, {z.y * x.z - z.z * x.y, z.z * x.x - z.x * x.z, z.x * x.y - z.y * x.x});

  const Rounded3 m = cross_exact(bump_tangent(z, du, r.slope.s[0]), bump_tangent(z, exact(r.dp_dv), r.slope.s[1]));
  const Rounded m2 = dot(m, m);
  if (undecided(m2, 1e-20) || m2.value < 1e-20) return {};
  const Rounded3 normal = m * rsqrt(m2);
  const Rounded side = dot(normal, z);
  if (undecided(side)) return {};
  append(row, side.value < 0 ? -normal : normal);
  return row;
}

}  // namespace

TEST(twin_test, reliefs_are_as_exact_as_their_formulas_let_them_be) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  Random random(1000);
  std::vector<Relief> cases;
  for (std::size_t i = 0; i < many(); ++i) {
    const glm::dvec3 n = random.direction(), t = glm::normalize(glm::cross(n, random.direction())), b = glm::cross(n, t);
    const double size = random.log_between(1e-10, 1e10), skew = random.log_between(1e-2, 1) * random.sign();
    const double near_flat = random.below(3) == 0 ? random.log_between(1e-6, 1e-2) : 1;
    cases.push_back(
        {packed(0.5 + 0.5 * near_flat * glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.unit())),
         packed(n),
         packed(size * t),
         packed(size * random.log_between(0.01, 100) * (b * skew + t * (1 - std::abs(skew)))),
         {{narrow(size * random.signed_log_between(1e-6, 1e3)), narrow(size * random.signed_log_between(1e-6, 1e3))}}});
  }
  Floats3 colors, normals, dp_du, dp_dv;
  std::vector<cl_float2> slopes;
  for (const Relief& r : cases)
    colors.push_back(r.color), normals.push_back(r.normal), dp_du.push_back(r.dp_du), dp_dv.push_back(r.dp_dv),
        slopes.push_back(r.slope);
  judge(
      run_twins("reliefs", cases.size(), 12, colors, normals, dp_du, dp_dv, slopes),
      {"decoded x", "decoded y", "decoded z", "tangent x", "tangent y", "tangent z", "bitangent x", "bitangent y",
       "bitangent z", "bump x", "bump y", "bump z"},
      [&](std::size_t i) { return relief(cases[i]); }, 0.05);
}
