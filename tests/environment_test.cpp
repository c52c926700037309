// What the device's arithmetic must be like, asked of a program built with the options that every kernel is built with.
#include "extremes.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair::test;

namespace {
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr const char* file = "environment_test.cl";

bool offers(cl_device_fp_config bit) { return (device().device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & bit) != 0; }
}  // namespace

// (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24 rounds (to even) to 1 + 2^-11: minus that 0 in two operations, 2^-24 in one.
TEST(environment_test, products_are_not_contracted) {
  const std::vector<float> x{1 + 0x1p-12f}, z{1 + 0x1p-11f};
  std::vector<float> unfused(1), fused(1);
  run(file, "product_less", 1, x, x, z, out(unfused), out(fused));
  EXPECT_EQ(unfused[0], 0.0f);
  EXPECT_EQ(fused[0], 0x1p-24f);
  record_law("X1");
}

TEST(environment_test, not_finite_is_seen_in_the_bits_and_nan_is_not_itself) {
  const std::vector<float> x{nan_value, -nan_value, infinity, -infinity, 0.0f, -0.0f, 1.0f, 3.4e38f, 1e-45f, -1e-39f};
  std::vector<cl_uint> bits(x.size()), unequal(x.size());
  run(file, "classify", x.size(), x, out(bits), out(unequal));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(bits[i], std::isfinite(x[i]) ? 0u : 1u) << x[i];
    EXPECT_EQ(unequal[i], std::isnan(x[i]) ? 1u : 0u) << x[i];
  }
  record_law("X2");
}

TEST(environment_test, operations_make_nan_and_infinity_where_ieee_does) {
  const std::vector<float> x{0.0f, infinity, 3e38f, -3e38f}, y{infinity, 0.0f, 2.0f, 2.0f};
  std::vector<float> product(x.size());
  run(file, "multiply", x.size(), x, y, out(product));
  EXPECT_TRUE(std::isnan(product[0]) && std::isnan(product[1]));
  EXPECT_EQ(product[2], infinity);
  EXPECT_EQ(product[3], -infinity);
  const std::vector<float> numerator{1.0f, -1.0f, 1.0f, 0.0f}, denominator{0.0f, 0.0f, -0.0f, 0.0f};
  std::vector<float> quotient(4);
  run(file, "divide", 4, numerator, denominator, out(quotient));
  EXPECT_EQ(quotient[0], infinity);
  EXPECT_EQ(quotient[1], -infinity);
  EXPECT_EQ(quotient[2], -infinity);
  EXPECT_TRUE(std::isnan(quotient[3]));
}

TEST(environment_test, fmin_and_fmax_ignore_nan_on_either_side) {
  const std::vector<float> x{nan_value, 1.0f, nan_value, -infinity, 2.0f}, y{1.0f, nan_value, -infinity, nan_value, 3.0f};
  const std::vector<float> low{1.0f, 1.0f, -infinity, -infinity, 2.0f}, high{1.0f, 1.0f, -infinity, -infinity, 3.0f};
  std::vector<float> least(x.size()), greatest(x.size());
  run(file, "minimum_maximum", x.size(), x, y, out(least), out(greatest));
  EXPECT_EQ(least, low);
  EXPECT_EQ(greatest, high);
}

// 0.1f is 0.100000001490116; Kahan's bound 2u keeps the sum at the float next to terms * 0.1f. Reassociated to a naive sum, a
// million terms give 100958.34; the bound allows one spacing of 2^-7 at 1e5.
TEST(environment_test, compensated_sums_survive_the_compiler) {
  const cl_uint terms = static_cast<cl_uint>(count_or_small(1000000, 20000));
  std::vector<float> sum(1);
  run(file, "kahan_sum", 1, 0.1f, terms, out(sum));
  const double exact = terms * static_cast<double>(0.1f);
  record_extreme("X2", std::abs(sum[0] - exact) / (unit_roundoff * exact), 2);
}

// The reference rounds the double quotient to float; with 53 >= 2 * 24 + 2 bits that is the correctly rounded quotient
// (Figueroa 1995), and likewise for the root. Without the flag OpenCL allows 2.5 and 3 ulp.
TEST(environment_test, division_is_correctly_rounded_where_the_device_offers_it) {
  Random random(3);
  const std::size_t count = count_or_small(2000000, 500);
  std::vector<float> x(count), y(count), quotient(count);
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = static_cast<float>(random.signed_log_between(1e-15, 1e15));
    y[i] = static_cast<float>(random.signed_log_between(1e-15, 1e15));
  }
  run(file, "divide", count, x, y, out(quotient));
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double exact = static_cast<double>(x[i]) / y[i];
    keep_worst(worst, std::abs(quotient[i] - exact) / ulp(exact));
  }
  record_extreme("X3", worst / (offers(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) ? 0.5 : 2.5), 1);
}

TEST(environment_test, square_root_is_correctly_rounded_where_the_device_offers_it) {
  Random random(4);
  const std::size_t count = count_or_small(2000000, 500);
  std::vector<float> x(count), root(count);
  for (float& value : x) value = static_cast<float>(std::abs(random.signed_log_between(1e-37, 1e38)));
  run(file, "square_root", count, x, out(root));
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double exact = std::sqrt(static_cast<double>(x[i]));
    keep_worst(worst, std::abs(root[i] - exact) / ulp(exact));
  }
  record_extreme("X3", worst / (offers(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) ? 0.5 : 3.0), 1);
}

// What the kernels call beside them: ulps of the full profile (OpenCL 1.2 specification, 7.4). Angles as environment maps take
// their sines, powers as sRGB does.
TEST(environment_test, functions_err_by_no_more_ulps_than_opencl_allows) {
  Random random(5);
  const std::size_t count = count_or_small(300000, 200);
  std::vector<float> x(count), y(count), angle(count), base(count);
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = static_cast<float>(random.signed_log_between(1e-6, 1e6));
    y[i] = static_cast<float>(random.signed_log_between(1e-6, 1e6));
    angle[i] = static_cast<float>(random.log_between(1e-6, 3.1));
    base[i] = static_cast<float>(random.between(0.04, 1.0));
  }
  std::vector<float> roots(count), sines(count), arcs(count), lengths(count), powers(count);
  run(file, "functions", count, x, y, angle, base, out(roots), out(sines), out(arcs), out(lengths), out(powers));
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const long double a = x[i], b = y[i];
    const auto judge = [&](float result, long double exact, double allowed) {
      keep_worst(worst, static_cast<double>(std::abs(result - exact)) / ulp(static_cast<double>(exact)) / allowed);
    };
    judge(roots[i], 1 / std::sqrt(std::abs(a)), 2);
    judge(sines[i], std::sin(static_cast<long double>(angle[i])), 4);
    judge(arcs[i], std::atan2(a, b), 6);
    judge(lengths[i], std::hypot(a, b), 4);
    judge(powers[i], std::pow(static_cast<long double>(base[i]), static_cast<long double>(2.4f)), 16);
  }
  record_extreme("X3", worst, 1);
}

// As results and as operands: 2^-126 / 2 is the largest power of two below the normal numbers, 2^-149 the smallest of all.
// Where the device does not say that it keeps them they may become 0, or not (OpenCL 1.2, 7.5.3): rusticl keeps them and does not say so.
TEST(environment_test, denormals_are_kept_where_the_device_says_so_unless_they_are_to_be_flushed) {
  const std::vector<float> x{0x1p-126f, 0x1p-127f, 0x1p-149f, 0x1p-126f}, y{0.5f, 2.0f, 0x1p100f, -0x1p-23f};
  const std::vector<float> kept{0x1p-127f, 0x1p-126f, 0x1p-49f, -0x1p-149f}, flushed{0.0f, 0.0f, 0.0f, -0.0f};
  std::vector<float> product(x.size());
  run(file, "multiply", x.size(), x, y, out(product));
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_TRUE(product[i] == (keeps_denormals() ? kept : flushed)[i] || (!offers(CL_FP_DENORM) && product[i] == kept[i]))
        << x[i] << " " << product[i];
  record_law("X4");
}
