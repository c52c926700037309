#include "inputs.h"
#include "kernel.h"

using namespace oclair::test;

namespace {

constexpr const char* file = "vector_test.cl";
using Vector = std::array<double, 3>;

Vector direction(Random& random) {
  const glm::dvec3 d = random.direction();
  return {d.x, d.y, d.z};
}


cl_float4 rounded(const Vector& v) {
  return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0f}};
}
Vector widened(const cl_float4& v) { return {v.s[0], v.s[1], v.s[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Products of floats are exact in double, and their difference is rounded once, at 2^-64, in long double.
double exact_difference(const cl_float4& v) {
  const long double ab = static_cast<double>(v.s[0]) * v.s[1], cd = static_cast<double>(v.s[2]) * v.s[3];
  return static_cast<double>(ab - cd);
}

std::vector<float> run_differences(const std::vector<cl_float4>& abcd) {
  std::vector<float> result(abcd.size());
  run(file, "difference", abcd.size(), abcd, out(result));
  return result;
}

// Jeannerod, Louvet and Muller 2013: Kahan's algorithm errs by at most 1.5 ulp.
void expect_differences_within_one_and_a_half_ulp(const std::vector<cl_float4>& abcd) {
  const std::vector<float> result = run_differences(abcd);
  for (std::size_t i = 0; i < abcd.size(); ++i) {
    const double exact = exact_difference(abcd[i]);
    ASSERT_LE(std::abs(result[i] - exact), exact == 0 ? 0 : 1.5 * ulp(exact)) << exact << " became " << result[i];
  }
}

std::vector<cl_float4> unit_normals() {
  // The last two break the frame of Frisvad 2012, which Duff et al. repair.
  std::vector<cl_float4> normals;
  for (const Vector& n : std::vector<Vector>{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {1, 0, -0.0},
                                             {0.6, 0.8, -0.0}, {-0.6, -0.8, 0.0}, {0.00038527316, 0.00038460016, -0.99999988079},
                                             {-0.00019813581, -0.00008946839, -0.99999988079}})
    normals.push_back(rounded(n));
  for (int k = 1; k <= 30; ++k)
    for (double sign : {1.0, -1.0}) {
      const double r = std::ldexp(1.0, -k);
      normals.push_back(rounded(normalized({r, -0.5 * r, sign})));
      normals.push_back(rounded(normalized({1, r, sign * r})));
    }
  Random random(20);
  for (std::size_t i = 0; i < count_or_small(100000, 100); ++i) normals.push_back(rounded(direction(random)));
  return normals;
}

struct Frames {
  std::vector<cl_float4> x, y, z;
};

Frames run_frames(const std::vector<cl_float4>& normals) {
  Frames frames{normals, normals, normals};
  run(file, "frame", normals.size(), normals, out(frames.x), out(frames.y), out(frames.z));
  return frames;
}

}  // namespace

TEST(vector_test, packing_keeps_order_and_bits) {
  const std::vector<cl_float4> vectors{{{1.0f, 2.0f, 3.0f, 9.0f}}, {{-0.0f, 1e-45f, 3e38f, 9.0f}}, {{7.0f, -8.0f, 0.1f, 9.0f}}};
  std::vector<oclair::packed_float3> packed(vectors.size());
  run(file, "pack", vectors.size(), vectors, out(packed));
  std::vector<cl_float4> unpacked(vectors.size());
  run(file, "unpack", vectors.size(), packed, out(unpacked));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    EXPECT_EQ(packed[i].x, vectors[i].s[0]);
    EXPECT_EQ(packed[i].y, vectors[i].s[1]);
    EXPECT_EQ(packed[i].z, vectors[i].s[2]);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(unpacked[i].s[axis], vectors[i].s[axis]);
  }
  EXPECT_TRUE(std::signbit(packed[1].x) && std::signbit(unpacked[1].s[0]));
}

TEST(vector_test, difference_of_products_errs_by_one_and_a_half_ulp_at_most) {
  Random random(21);
  std::vector<cl_float4> abcd(count_or_small(200000, 200));
  for (cl_float4& v : abcd)
    for (float& component : v.s) component = static_cast<float>(random.signed_log_between(1e-8, 1e8));
  expect_differences_within_one_and_a_half_ulp(abcd);
}

// d = ab/c rounded: the difference is the rounding error of a product, all of which a*b - c*d loses.
TEST(vector_test, difference_of_products_survives_cancellation) {
  Random random(22);
  std::vector<cl_float4> abcd(count_or_small(200000, 200));
  for (cl_float4& v : abcd) {
    for (float& component : v.s) component = static_cast<float>(random.signed_log_between(1e-4, 1e4));
    v.s[3] = static_cast<float>(static_cast<double>(v.s[0]) * v.s[1] / v.s[2]);
  }
  expect_differences_within_one_and_a_half_ulp(abcd);
}

TEST(vector_test, cross_exact_errs_by_one_and_a_half_ulp_in_each_component) {
  Random random(23);
  const std::size_t count = count_or_small(100000, 200);
  std::vector<cl_float4> a(count), b(count), result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector u{random.signed_log_between(1e-4, 1e4), random.signed_log_between(1e-4, 1e4), random.signed_log_between(1e-4, 1e4)};
    const double factor = random.between(-2, 2), noise = i % 2 ? 1 : 1e-6;  // every other pair nearly parallel
    a[i] = rounded(u);
    b[i] = rounded({factor * u[0] + noise * random.between(-1, 1), factor * u[1] + noise * random.between(-1, 1),
                    factor * u[2] + noise * random.between(-1, 1)});
  }
  run(file, "cross_product", count, a, b, out(result));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t y = (axis + 1) % 3, z = (axis + 2) % 3;
      const double exact = exact_difference({{a[i].s[y], b[i].s[z], a[i].s[z], b[i].s[y]}});
      ASSERT_LE(std::abs(result[i].s[axis] - exact), 1.5 * ulp(exact)) << "pair " << i << " axis " << axis;
    }
}

TEST(vector_test, cross_exact_of_parallel_vectors_is_zero) {
  Random random(24);
  std::vector<cl_float4> a(count_or_small(10000, 100)), b(a.size()), result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = rounded({random.signed_log_between(1e-4, 1e4), random.signed_log_between(1e-4, 1e4), random.signed_log_between(1e-4, 1e4)});
    for (std::size_t axis = 0; axis < 3; ++axis) b[i].s[axis] = a[i].s[axis] * (i % 2 ? -4.0f : 0.5f);
  }
  run(file, "cross_product", a.size(), a, b, out(result));
  for (const cl_float4& v : result)
    for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_EQ(v.s[axis], 0.0f);
}

// One step of Newton's method for 1/|d| at |d| = 1 + delta: length (1 + delta)(1.5 - (1 + delta)^2 / 2) = 1 - 1.5 delta^2 -
// delta^3 / 2. Rounding: d.d 3u, half of which counts; the subtraction u; the products u: below 4u.
TEST(vector_test, renormalize_squares_the_drift_and_keeps_the_direction) {
  Random random(25);
  std::vector<cl_float4> d(count_or_small(50000, 200)), result(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) {
    const Vector unit = direction(random);
    const double length = 1 + (i % 3 == 0 ? 0 : random.signed_log_between(1e-7, 1e-2));
    d[i] = rounded({unit[0] * length, unit[1] * length, unit[2] * length});
  }
  run(file, "renormalized", d.size(), d, out(result));
  for (std::size_t i = 0; i < d.size(); ++i) {
    const Vector before = widened(d[i]), after = widened(result[i]);
    const double delta = std::sqrt(dot(before, before)) - 1, length = std::sqrt(dot(after, after));
    ASSERT_NEAR(length - 1, -1.5 * delta * delta - 0.5 * delta * delta * delta, 4 * unit_roundoff) << delta;
    const Vector off = cross(before, after);
    ASSERT_LE(std::sqrt(dot(off, off)), 2 * unit_roundoff) << delta;  // each component is rounded once: sqrt(3) u at most
    ASSERT_GT(dot(before, after), 0);
  }
}

TEST(vector_test, max_component_is_the_largest_wherever_it_stands) {
  const std::vector<cl_float4> v{{{1, 2, 3, 99}}, {{1, 3, 2, 99}}, {{3, 2, 1, 99}}, {{-3, -2, -1, 99}}, {{-1, -2, -3, 99}},
                                 {{-2, -1, -3, 99}}, {{0, 0, 0, 99}}, {{5, 5, 4, 99}}};
  std::vector<float> result(v.size());
  run(file, "largest", v.size(), v, out(result));
  EXPECT_EQ(result, (std::vector<float>{3, 3, 3, -1, -1, -1, 0, 5}));
}

// Normals are rounded to float, so they are unit vectors to sqrt(3) u; Duff et al. 2017 report errors below 1e-6 in float.
TEST(vector_test, frame_is_orthonormal_and_right_handed) {
  const std::vector<cl_float4> normals = unit_normals();
  const Frames frames = run_frames(normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vector x = widened(frames.x[i]), y = widened(frames.y[i]), z = widened(frames.z[i]);
    const double worst = std::max({std::abs(dot(x, x) - 1), std::abs(dot(y, y) - 1), std::abs(dot(x, y)), std::abs(dot(y, z)),
                                   std::abs(dot(z, x)), std::abs(dot(cross(x, y), z) - 1)});
    ASSERT_LT(worst, 1e-6) << z[0] << " " << z[1] << " " << z[2];
  }
}

TEST(vector_test, frame_has_the_normal_itself_as_its_z) {
  const std::vector<cl_float4> normals = unit_normals();
  const Frames frames = run_frames(normals);
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_EQ(frames.z[i].s[axis], normals[i].s[axis]);
}

// Three products and two sums of terms of at most |v| = 1: 5u each component.
TEST(vector_test, local_coordinates_are_projections_and_world_coordinates_are_combinations) {
  const std::vector<cl_float4> normals = unit_normals();
  const Frames frames = run_frames(normals);
  Random random(26);
  std::vector<cl_float4> v(normals.size()), local(v), world(v);
  for (cl_float4& vector : v) vector = rounded(direction(random));
  run(file, "change_frame", v.size(), frames.x, frames.y, frames.z, v, out(local), out(world));
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::array<Vector, 3> axes{widened(frames.x[i]), widened(frames.y[i]), widened(frames.z[i])};
    const Vector wide = widened(v[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(local[i].s[k], dot(axes[k], wide), 5 * unit_roundoff);
      ASSERT_NEAR(world[i].s[k], axes[0][k] * wide[0] + axes[1][k] * wide[1] + axes[2][k] * wide[2], 5 * unit_roundoff);
    }
  }
}

// The frame's own error of 1e-6 and the rounding of the two changes.
TEST(vector_test, to_world_undoes_to_local) {
  const std::vector<cl_float4> normals = unit_normals();
  const Frames frames = run_frames(normals);
  Random random(27);
  std::vector<cl_float4> v(normals.size()), local(v), back(v), unused(v);
  for (cl_float4& vector : v) vector = rounded(direction(random));
  run(file, "change_frame", v.size(), frames.x, frames.y, frames.z, v, out(local), out(unused));
  run(file, "change_frame", v.size(), frames.x, frames.y, frames.z, local, out(unused), out(back));
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(back[i].s[k], v[i].s[k], 1.6e-6);
}
