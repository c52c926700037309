// The self-test passes here, and fails in the right groups for each fault that is planted in a copy of its kernels or in its
// compiler's flags.
#include "../host/selftest/selftest.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "../host/selftest/launch.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

using namespace oclair;

namespace {

using Names = std::set<std::string>;

// Text of a kernel source, and what takes its place wherever it stands.
struct Change {
  std::string file, text, by;
};

void copy_kernels(const std::filesystem::path& directory, const std::vector<Change>& changes) {
  std::filesystem::copy(kernel_directory(), directory);
  for (const Change& change : changes) {
    std::string source = content(directory / change.file);
    std::size_t found = 0;
    for (std::size_t at = 0; (at = source.find(change.text, at)) != std::string::npos; at += change.by.size(), ++found)
      source.replace(at, change.text.size(), change.by);
    ASSERT_GT(found, 0u) << change.file << " no longer has: " << change.text;
    put(directory / change.file, source);
  }
}

Names failed(const selftest::Report& report) {
  Names names;
  for (const selftest::Group& group : report.groups)
    if (!group.passed()) names.insert(group.name);
  return names;
}

const selftest::Group& group_of(const selftest::Report& report, const std::string& name) {
  return *std::find_if(report.groups.begin(), report.groups.end(),
                       [&](const selftest::Group& group) { return group.name == name; });
}

std::string lines(const selftest::Report& report) {
  std::string text;
  for (const selftest::Group& group : report.groups) text += line_of(group) + "\n";
  return text;
}

void expect_failures(const selftest::Report& report, const Names& names) {
  EXPECT_EQ(failed(report), names) << lines(report);
}

// All groups, or one, the fault planted.
selftest::Report with_changes(const std::vector<Change>& changes, const std::string& only = {}) {
  const TemporaryDirectory directory;
  Device device = open_device();
  device.kernels = directory / "cl";
  copy_kernels(device.kernels, changes);
  return selftest::run_selftest(device, {}, only);
}

selftest::Report with_flags(const std::string& flags, const std::string& only = {}) {
  Device device = open_device();
  device.flags = flags;
  return selftest::run_selftest(device, {}, only);
}

// What a kernel of its own makes of floats, compiled with the flags: whether a fault shows on this device at all. Many work
// items, since compilers do other things with several of them at a time.
std::vector<float> probe(const std::string& expression, const std::string& flags, const std::vector<float>& x, float y) {
  const Device device = open_device();
  const std::string source =
      "#pragma OPENCL FP_CONTRACT ON\n"
      "__kernel void probe(uint count, __global const float *xs, float y, __global float *r) {\n"
      "  size_t i = get_global_id(0);\n"
      "  if (i >= count) return;\n"
      "  float x = xs[i];\n"
      "  r[i] = " + expression + ";\n}\n";
  cl::Program program(device.context, source);
  program.build({device.device}, ("-cl-std=CL1.2 " + flags).c_str());
  std::vector<float> result(x.size());
  test::launch(device, program, "probe", x.size(), x, y, test::out(result));
  return result;
}

bool folds_comparisons_of_nan(const std::string& flags) {
  return probe("x != x ? 1.0f : 0.0f", flags, std::vector<float>(256, std::nanf("")), 0.0f)[0] == 0.0f;
}

bool rounds_quotients_wrongly(const std::string& flags) {
  std::vector<float> x(256);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 1.0f + 0.037f * static_cast<float>(i);
  const std::vector<float> result = probe("y / x", flags, x, 1.0f);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (result[i] != 1.0f / x[i]) return true;
  return false;
}

}  // namespace

TEST(selftest_test, every_group_passes_on_this_device) {
  const selftest::Report report = selftest::run_selftest(open_device());
  expect_failures(report, {});
  EXPECT_GE(report.groups.size(), 16u);
  for (const selftest::Group& group : report.groups) EXPECT_FALSE(group.figures.empty()) << group.name;
}

// Of four on a CPU: what other devices have.
TEST(selftest_test, every_group_passes_with_nodes_of_the_other_width_too) {
  Device device = open_device();
  device.bvh_width = device.bvh_width == 4 ? 8 : 4;
  expect_failures(selftest::run_selftest(device), {});
}

// (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24, whose last bit is lost unless the product is fused: where it is, a compiler contracts
// what the sources let it, edges are no longer antisymmetric, and rays pass between triangles. Where it is not, nothing is
// wrong without the pragma.
TEST(selftest_test, contraction_fails_by_itself_and_where_rays_pass_between_triangles) {
  const bool contracts = probe("x * x - y", "", {1 + 0x1p-12f}, 1 + 0x1p-11f)[0] != 0.0f;
  const selftest::Report report =
      with_changes({{"types.h", "#pragma OPENCL FP_CONTRACT OFF", "#pragma OPENCL FP_CONTRACT ON"}});
  expect_failures(report, contracts ? Names{"contraction", "triangles"} : Names{});
}

// A compiler that is told that there are no NaNs may fold x != x. Where the probe says that it does, the group of exceptions
// fails.
TEST(selftest_test, finite_math_only_fails_as_exceptions_where_it_folds_comparisons) {
  const std::string flags = "-cl-finite-math-only";
  expect_failures(with_flags(flags, "exceptions"), folds_comparisons_of_nan(flags) ? Names{"exceptions"} : Names{});
}

TEST(selftest_test, fast_relaxed_math_fails_where_it_folds_comparisons_and_where_it_rounds_quotients_wrongly) {
  const std::string flags = "-cl-fast-relaxed-math";
  expect_failures(with_flags(flags, "exceptions"), folds_comparisons_of_nan(flags) ? Names{"exceptions"} : Names{});
  const bool promised =
      (open_device().device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  const bool wrong = promised && rounds_quotients_wrongly(flags + " -cl-fp32-correctly-rounded-divide-sqrt");
  expect_failures(with_flags(flags, "accuracy"), wrong ? Names{"accuracy"} : Names{});
}

// A device that says that it keeps denormals and does not is wrong, but nothing else is.
TEST(selftest_test, flushed_denormals_fail_as_denormals_and_spoil_nothing_else) {
  const std::string flags = "-cl-denorms-are-zero";
  const bool flushes = probe("x * y", flags, {0x1p-100f}, 0x1p-30f)[0] == 0.0f;
  const bool promised = (open_device().device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_DENORM) != 0;
  expect_failures(with_flags(flags), flushes && promised ? Names{"denormals"} : Names{});
}

TEST(selftest_test, rays_that_start_on_their_surface_fail_as_surfaces) {
  const selftest::Report report =
      with_changes({{"surface.h", "float distance = dot(fabs(normal), error);", "float distance = 0.0f;"}});
  expect_failures(report, {"surfaces"});
  EXPECT_FALSE(group_of(report, "surfaces").figure("that hit their own triangle").passed());
}

TEST(selftest_test, rays_that_start_a_fixed_distance_off_their_surface_fail_as_surfaces) {
  expect_failures(
      with_changes({{"surface.h", "float distance = dot(fabs(normal), error);", "float distance = 1e-4f;"}}, "surfaces"),
      {"surfaces"});
}

TEST(selftest_test, random_numbers_that_can_be_1_fail_as_samplers) {
  const selftest::Report report = with_changes({{"rng.h", "(bits >> 8) * 0x1p-24f", "bits * 0x1p-32f"}});
  expect_failures(report, {"sampler"});
  EXPECT_FALSE(group_of(report, "sampler").figure("outside [0, 1)").passed());
}

// Fused by hand: the two products of an edge function are rounded differently, so that an edge has two signs.
TEST(selftest_test, edges_that_are_not_antisymmetric_fail_as_triangles) {
  expect_failures(with_changes({{"triangle.h", "cx * by - cy * bx", "fma(cx, by, -(cy * bx))"},
                                {"triangle.h", "ax * cy - ay * cx", "fma(ax, cy, -(ay * cx))"},
                                {"triangle.h", "bx * ay - by * ax", "fma(bx, ay, -(by * ax))"}}),
                  {"triangles"});
}

TEST(selftest_test, boxes_without_padding_fail_as_boxes_and_let_rays_pass) {
  expect_failures(with_changes({{"traverse.h", "fma(load_lanes(node->bounds[row]),",
                                 "fma(load_lanes(node->bounds[row]) + ((row) & 1u ? -0x1p-19f : 0x1p-19f),"}}),
                  {"boxes", "triangles"});
}

// NaN is not below any bound, but it is not above one either, and the numbers that follow are.
TEST(selftest_test, results_that_are_not_numbers_fail_their_group_all_of_them_or_one) {
  const auto expect_nan = [](const Change& change, const std::string& group, const std::string& figure) {
    const selftest::Report report = with_changes({change}, group);
    expect_failures(report, {group});
    EXPECT_FALSE(group_of(report, group).figure(figure).passed()) << lines(report);
  };
  const std::string kahan = "difference_of_products(v.x, v.y, v.z, v.w));", root = "sqrt(v.x), rsqrt(v.x)";
  expect_nan({"selftest.cl", kahan, "NAN);"}, "contraction", "ulp of a b - c d by Kahan");
  expect_nan({"selftest.cl", kahan, "i == 1000 ? NAN : " + kahan}, "contraction", "ulp of a b - c d by Kahan");
  expect_nan({"selftest.cl", root, "i == 1000 ? NAN : " + root}, "accuracy", "sqrt");
}

// Directions that are made of it are none: every group has its verdict all the same.
TEST(selftest_test, a_function_that_gives_nan_everywhere_fails_and_every_group_has_its_verdict) {
  const selftest::Report report = with_changes({{"vector.h", "return fma(a, b, -cd) + error;", "return NAN;"}});
  EXPECT_EQ(report.groups.size(), selftest::run_selftest(open_device()).groups.size());
  const Names names = failed(report);
  EXPECT_TRUE(names.count("contraction") && names.count("surfaces")) << lines(report);
}

// One fault more for each group that the others leave out.
TEST(selftest_test, every_group_finds_a_fault_of_its_own) {
  struct Fault {
    std::string group;
    Change change;
  };
  const Fault faults[] = {
      {"layout", {"types.h", "float b1, b2;    // triangle", "float b2, b1;    // triangle"}},
      {"integers", {"film.h", "*carry = overflow | (sum < *carry);", "*carry = overflow;"}},
      {"film",
       {"film.h", "value = shift > -64 ? (value + (1ul << (-shift - 1))) >> -shift : 0ul;",
        "value = shift > -64 ? value >> -shift : 0ul;"}},
      {"sampler", {"sobol.h", "digits ^= digits << 1 & 10u;", "digits ^= digits << 1 & 8u;"}},
      {"warps", {"warp.h", "sqrt(1.0f - u.x)", "sqrt(1.0f - d.x * d.x - d.y * d.y)"}},
      {"mis", {"mis.h", "return 1.0f / fma(r, r, 1.0f);", "return a * a / (a * a + b * b);"}},
      {"fresnel",
       {"fresnel.h", "f.transmittance = 2.0f * c * g * fma(i.eta2, inverse_q2, inverse_p2);",
        "f.transmittance = 1.0f - f.reflectance;"}},
      {"textures", {"texture.h", "(uint)clamp(convert_int_sat(x), 0, (int)n - 1)", "(uint)convert_int_sat(x)"}},
      {"accuracy", {"selftest.cl", "1.0f / v.y, sqrt(v.x)", "1.0f / v.y, 1.0f / rsqrt(v.x)"}},
      {"render",
       {"path.h", "float weight = path->pdf > 0.0f ? mis_scattering_weight(path->pdf, light_pdf) : 1.0f;", "float weight = 1.0f;"}},
  };
  for (const Fault& fault : faults) expect_failures(with_changes({fault.change}, fault.group), {fault.group});
}

// Products that are not denormal, of factors that are not, have no reason to be 0.
TEST(selftest_test, a_normal_product_that_becomes_0_is_wrong_and_not_flushed) {
  const std::string product = "xy[i].x * xy[i].y";
  const selftest::Report report =
      with_changes({{"selftest.cl", "result[i] = " + product, "result[i] = fabs(" + product + ") < 0x1p-125f ? 0.0f : " + product}}, "denormals");
  expect_failures(report, {"denormals"});
  EXPECT_FALSE(group_of(report, "denormals").figure("wrong").passed()) << lines(report);
}

TEST(selftest_test, a_zero_without_its_sign_and_a_difference_that_is_off_by_an_ulp_fail_as_exceptions) {
  const std::string results = "(float8)(x + y, x - y, x * y,";
  for (const std::string wrong : {"(float8)(x + y, x - y, x * y + 0.0f,", "(float8)(x + y, (x - y) * (1.0f + FLT_EPSILON), x * y,"})
    expect_failures(with_changes({{"selftest.cl", results, wrong}}, "exceptions"), {"exceptions"});
}

TEST(selftest_test, a_program_that_does_not_compile_is_an_error_of_the_device) {
  try {
    with_changes({{"selftest.cl", "PROBE layout(uint count,", "PROBE layout(unknown count,"}});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::device);
    EXPECT_NE(std::string(error.what()).find("selftest.cl: does not compile"), std::string::npos) << error.what();
  }
}

TEST(selftest_test, a_kernel_that_is_missing_fails_its_group_and_no_other) {
  const selftest::Report report = with_changes({{"selftest.cl", "PROBE mis_weights(", "PROBE other_weights("}});
  expect_failures(report, {"mis"});
}

TEST(selftest_test, figures_that_are_not_numbers_have_not_passed) {
  EXPECT_FALSE((selftest::Figure{"error", std::nan(""), 1.0}).passed());
  EXPECT_TRUE((selftest::Figure{"error", 1.0, 1.0}).passed());
  EXPECT_FALSE((selftest::Figure{"error", std::nextafter(1.0, 2.0), 1.0}).passed());
  EXPECT_TRUE((selftest::Figure{"count", 1e300}).passed());
}

TEST(selftest_test, json_says_what_the_lines_say_and_survives_figures_that_are_not_numbers) {
  selftest::Report report{"a device \xff"};  // drivers give names in any encoding
  selftest::Group good{"good"}, bad{"bad"}, broken{"broken"};
  good.measure("rays", 12345);
  good.say("denormals", "kept");
  bad.bound("ulp", std::nan(""), 0.5);
  broken.error = "clEnqueue returned -5";
  report.groups = {good, bad, broken};
  EXPECT_EQ(lines(report),
            "good         pass  rays 12345, denormals kept\n"
            "bad          FAIL  ulp nan (not <= 0.5)\n"
            "broken       FAIL  clEnqueue returned -5\n");
  const nlohmann::json parsed = nlohmann::json::parse(report.json());
  EXPECT_EQ(parsed["passed"], false);
  EXPECT_EQ(parsed["groups"][0]["figures"][0]["value"], 12345);
  EXPECT_EQ(parsed["groups"][0]["figures"][1]["value"], "kept");
  EXPECT_TRUE(parsed["groups"][1]["figures"][0]["value"].is_null());
  EXPECT_EQ(parsed["groups"][1]["figures"][0]["most"], 0.5);
  EXPECT_EQ(parsed["groups"][1]["passed"], false);
  EXPECT_EQ(parsed["groups"][2]["error"], "clEnqueue returned -5");
}

TEST(selftest_test, the_command_exits_with_0_writes_a_line_for_each_group_and_the_same_as_json) {
  const TemporaryDirectory directory;
  const ProgramResult result = run_oclair({"selftest", "--json", directory / "report.json"});
  EXPECT_EQ(result.exit, 0) << result.out << result.err;
  const nlohmann::json report = nlohmann::json::parse(content(directory / "report.json"));
  EXPECT_EQ(report["passed"], true);
  EXPECT_EQ(report["program"], "oclair " OCLAIR_VERSION);
  for (const auto& group : report["groups"]) {
    EXPECT_NE(result.out.find("\n" + group["name"].get<std::string>() + " "), std::string::npos) << result.out;
    EXPECT_EQ(group["passed"], true);
  }
  EXPECT_NE(result.out.find("all " + std::to_string(report["groups"].size()) + " groups passed"), std::string::npos)
      << result.out;
}

// The program finds its kernels beside itself, where it is installed: here with one that is wrong. With - nothing but JSON
// is on standard output.
TEST(selftest_test, the_command_exits_with_7_and_names_the_groups_that_failed) {
  const TemporaryDirectory directory;
  std::filesystem::create_directories(directory / "bin");
  std::filesystem::create_directories(directory / "share/oclair");
  std::filesystem::copy_file(OCLAIR_PROGRAM, directory / "bin/oclair");
  copy_kernels(directory / "share/oclair/cl", {{"mis.h", "return 0.5f;", "return 0.75f;"}});
  const std::string out = directory / "out", err = directory / "err";
  const int status =
      std::system(((directory / "bin/oclair").string() + " selftest --json - > " + out + " 2> " + err).c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
  const nlohmann::json report = nlohmann::json::parse(content(out));
  EXPECT_EQ(report["passed"], false);
  for (const auto& group : report["groups"]) EXPECT_EQ(group["passed"], group["name"] != "mis");
  EXPECT_NE(content(err).find("\nmis          FAIL  "), std::string::npos) << content(err);
  EXPECT_NE(content(err).find("\nfailed: mis, in "), std::string::npos) << content(err);
}

TEST(selftest_test, what_cannot_begin_is_refused_at_once) {
  const auto expect = [](const std::vector<std::string>& arguments, int exit, const std::string& message) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, exit) << message;
    EXPECT_EQ(result.out, "") << message;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  };
  expect({"selftest", "--device", "no such device"}, 4,
         "device \"no such device\" does not exist: expected an index below ");
  expect({"selftest", "--json", "/no/such/directory/report.json"}, 1,
         "oclair: /no/such/directory/report.json: cannot be written, expected a file in a writable directory\n");
  expect({"selftest", "--json", ""}, 1, "cannot be written");
  expect({"selftest", "triangles"}, 2, "triangles");
  expect({"selftest", "--json"}, 2, "--json");
}
