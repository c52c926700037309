// The program on real scenes: what it writes, where it says it, and how it ends.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "../host/device.h"
#include "exr_reader.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

namespace fs = std::filesystem;

const fs::path scenes = fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes";

// Arguments that render the furnace in a moment.
std::vector<std::string> quick(const fs::path& output, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"render", (scenes / "furnace.xml").string(), "-o", output.string(), "--spp", "2", "--size", "16x8"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::string shell_line(const fs::path& program, const std::vector<std::string>& arguments) {
  std::string line = "'" + program.string() + "'";
  for (const std::string& argument : arguments) line += " '" + argument + "'";
  return line;
}

fs::path write(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return file;
}

}  // namespace

TEST(render_command_test, names_of_the_files_go_to_stdout_and_phases_to_stderr) {
  const TemporaryDirectory directory;
  const fs::path exr = directory / "a.exr";
  const ProgramResult result = run_oclair(quick(exr, {"--png"}));
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.out, exr.string() + "\n" + (directory / "a.png").string() + "\n");
  std::size_t at = 0;
  for (const char* phase : {"parse", "meshes", "BVH", "kernels", "passes", "write"}) {
    at = result.err.find(phase, at);
    EXPECT_NE(at, std::string::npos) << phase << " is missing or out of order in:\n" << result.err;
  }
  EXPECT_EQ(directory.names().size(), 2u);
}

TEST(render_command_test, on_one_terminal_the_names_of_the_files_have_lines_of_their_own) {
  const TemporaryDirectory directory;
  const fs::path exr = directory / "a.exr", log = directory / "log";
  ASSERT_EQ(std::system((shell_line(OCLAIR_PROGRAM, quick(exr, {"--png"})) + " >'" + log.string() + "' 2>&1").c_str()), 0);
  const std::string names = "\n" + exr.string() + "\n" + (directory / "a.png").string() + "\n";
  EXPECT_NE(content(log).find(names), std::string::npos) << content(log);
}

// No option of a kernel compiler can hold a blank, so no path may be one.
TEST(render_command_test, an_installation_with_a_blank_in_its_path_renders) {
  const TemporaryDirectory directory;
  const fs::path program = directory / "a place/bin/oclair", exr = directory / "a.exr";
  fs::create_directories(program.parent_path());
  fs::copy_file(OCLAIR_PROGRAM, program);
  fs::create_directories(directory / "a place/share/oclair");
  fs::copy(scenes.parent_path() / "cl", directory / "a place/share/oclair/cl");
  EXPECT_EQ(std::system((shell_line(program, quick(exr)) + " >/dev/null 2>&1").c_str()), 0);
  EXPECT_TRUE(fs::exists(exr));
}

TEST(render_command_test, two_equal_runs_write_equal_bytes) {
  setenv("SOURCE_DATE_EPOCH", "0", 1);
  const TemporaryDirectory directory;
  const fs::path first = directory / "a.exr", second = directory / "b.exr";
  ::setenv("SOURCE_DATE_EPOCH", "0", 1);  // without it their command lines and seconds differ
  const int exit_of_first = run_oclair(quick(first, {"--png"})).exit, exit_of_second = run_oclair(quick(second, {"--png"})).exit;
  ::unsetenv("SOURCE_DATE_EPOCH");
  ASSERT_EQ(exit_of_first, 0);
  ASSERT_EQ(exit_of_second, 0);
  EXPECT_EQ(content(first), content(second));
  EXPECT_EQ(content(directory / "a.png"), content(directory / "b.png"));
  unsetenv("SOURCE_DATE_EPOCH");
}

TEST(render_command_test, seed_changes_the_image_and_size_its_size) {
  const TemporaryDirectory directory;
  const fs::path first = directory / "a.exr", second = directory / "b.exr";
  ASSERT_EQ(run_oclair(quick(first)).exit, 0);
  ASSERT_EQ(run_oclair(quick(second, {"--seed", "5"})).exit, 0);
  const ExrFile a = read_exr(first), b = read_exr(second);
  EXPECT_EQ(a.channels.at("R").size(), 16u * 8u);
  EXPECT_NE(a.channels.at("R"), b.channels.at("R"));
}

TEST(render_command_test, max_depth_one_shows_emission_only) {
  const TemporaryDirectory directory;
  const fs::path exr = directory / "a.exr";
  ASSERT_EQ(run_oclair(quick(exr, {"--max-depth", "1"})).exit, 0);
  const ExrFile file = read_exr(exr);
  for (float value : file.channels.at("G")) EXPECT_EQ(value, 1.0f);
}

TEST(render_command_test, definition_reaches_the_scene) {
  const TemporaryDirectory directory;
  const fs::path exr = directory / "a.exr";
  ASSERT_EQ(run_oclair(quick(exr, {"-D", "reflectance=0"})).exit, 0);
  const ExrFile file = read_exr(exr);
  for (float value : file.channels.at("G")) EXPECT_EQ(value, 1.0f);
}

struct Failure {
  std::vector<std::string> arguments;
  int exit;
  std::string message;
};

TEST(render_command_test, a_failure_has_its_exit_code_one_line_and_leaves_no_file) {
  const TemporaryDirectory directory;
  const std::string out = (directory / "out.exr").string();
  const std::string nowhere = (directory / "missing").string() + "/";
  const TemporaryDirectory inputs;
  const std::string broken = write(inputs / "broken.xml", "<scene version=\"3.0.0\">\n  <shape type=\"sphere\">\n").string();
  const std::string crop = write(inputs / "crop.xml",
                                 "<scene version=\"3.0.0\"><emitter type=\"constant\"/><integrator type=\"path\"/><sensor type=\"perspective\">"
                                 "<float name=\"fov\" value=\"40\"/><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"4\"/></film></sensor></scene>")
                               .string();
  const std::string furnace = (scenes / "furnace.xml").string();
  const Failure failures[] = {
      {{"render", "nowhere.xml", "-o", out}, 3, "nowhere.xml"},
      {{"render", broken, "-o", out}, 3, "broken.xml:"},
      {{"render", furnace, "-o", out, "-D", "colour=3"}, 2, "colour"},
      {{"render", crop, "-o", out, "--size", "8x8"}, 2, "crop window"},
      {{"render", furnace, "-o", out, "--device", "99"}, 4, "device \"99\" does not exist"},
      {{"render", furnace, "-o", out, "--device", "no such thing"}, 4, "device \"no such thing\" does not exist"},
      {{"render", furnace, "-o", out, "--arithmetic", "half"}, 2, "--arithmetic 'half': expected float or double"},
      {{"render", furnace, "-o", nowhere + "out.exr"}, 1, nowhere + "out.exr"},
      {{"render", furnace, "-o", out, "--png", nowhere + "out.png"}, 1, nowhere + "out.png"},
      {{"info", "nowhere.xml"}, 3, "nowhere.xml"},
      {{"info", furnace, "--device", "99"}, 4, "device \"99\" does not exist"},
  };
  for (const Failure& failure : failures) {
    const ProgramResult result = run_oclair(failure.arguments);
    EXPECT_EQ(result.exit, failure.exit) << failure.message << "\n" << result.err;
    const std::size_t line = result.err.find("oclair: ");
    ASSERT_NE(line, std::string::npos) << result.err;
    EXPECT_NE(result.err.find(failure.message, line), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find('\n', line), result.err.size() - 1) << "more than one line: " << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_EQ(directory.names().size(), 0u);
}

TEST(render_command_test, without_an_opencl_platform_the_device_is_what_fails) {
  ::setenv("OCL_ICD_VENDORS", "/nonexistent", 1);
  const ProgramResult list = run_oclair({"devices"});
  const ProgramResult render = run_oclair(quick("unused.exr"));
  ::unsetenv("OCL_ICD_VENDORS");
  EXPECT_EQ(list.exit, 4);
  EXPECT_NE(list.err.find("no OpenCL device found: expected an OpenCL driver"), std::string::npos) << list.err;
  EXPECT_NE(list.err.find("POCL_CACHE_DIR"), std::string::npos) << list.err;  // without a cache PoCL has no devices either
  EXPECT_EQ(render.exit, 4);
}

TEST(render_command_test, a_scene_without_light_is_black_and_says_so) {
  const TemporaryDirectory directory;
  const fs::path scene = write(directory / "dark.xml",
                               "<scene version=\"3.0.0\">\n<integrator type=\"path\"/>\n<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>"
                               "</sensor>\n<shape type=\"sphere\"/>\n</scene>");
  const fs::path exr = directory / "dark.exr";
  const ProgramResult result = run_oclair({"render", scene.string(), "-o", exr.string(), "--spp", "1", "--size", "4x4"});
  EXPECT_EQ(result.exit, 0);
  EXPECT_NE(result.err.find("no light: the image will be black"), std::string::npos) << result.err;
  const ExrFile file = read_exr(exr);
  for (float value : file.channels.at("R")) EXPECT_EQ(value, 0.0f);
}

// A lamp so far away that what arrives is 1e-42: some hundred of the smallest numbers.
TEST(render_command_test, light_that_is_too_weak_for_float_has_a_warning_and_a_picture) {
  const TemporaryDirectory directory;
  const fs::path scene =
      write(directory / "weak.xml",
            "<scene version=\"3.0.0\">\n<integrator type=\"path\"/>\n<sensor type=\"perspective\"><float name=\"fov\" "
            "value=\"20\"/>"
            "<transform name=\"to_world\"><lookat origin=\"0,0,4\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>\n"
            "<shape type=\"sphere\"/>\n<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0\" z=\"1e6\"/>"
            "<rgb name=\"intensity\" value=\"$intensity\"/></emitter>\n</scene>");
  const fs::path exr = directory / "weak.exr";
  for (const auto& [intensity, warned] : {std::pair("1e-30", true), {"1e-20", false}}) {
    const ProgramResult result = run_oclair({"render", scene.string(), "-o", exr.string(), "--spp", "1", "--size", "4x4",
                                             "-D", std::string("intensity=") + intensity});
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.err.find("is below the smallest normal float, 1.2e-38, and loses digits") != std::string::npos, warned)
        << result.err;
    const ExrFile file = read_exr(exr);
    for (const float value : file.channels.at("R")) EXPECT_GT(value, 0.0f);
  }
}

// A lamp 7e-7 of the scene above a plate lights what is below it beyond the film's headroom: of such pixels nothing is known. Said at
// once, since a render without another limit would go on for ever.
TEST(render_command_test, pixels_of_which_nothing_is_known_are_warned_of_before_the_end) {
  const TemporaryDirectory directory;
  const fs::path scene =
      write(directory / "near.xml",
            "<scene version=\"3.0.0\">\n<integrator type=\"path\"/>\n<sensor type=\"orthographic\"><transform name=\"to_world\">"
            "<scale value=\"1e-7\"/><lookat origin=\"0.5,0,1\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>\n"
            "<shape type=\"rectangle\"/>\n<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0\" z=\"7e-7\"/>"
            "<rgb name=\"intensity\" value=\"1\"/></emitter>\n</scene>");
  const ProgramResult result = run_oclair({"render", scene.string(), "-o", (directory / "near.exr").string(), "--size", "8x8",
                                           "--error", "0.5", "--spp", "48", "--progress", "json"});
  EXPECT_EQ(result.exit, 5) << result.err;
  const std::string unknown = "pixels of which all samples of a block were left out: ";
  const std::size_t early = result.err.find("the error will not be certified: " + unknown),
                    late = result.err.find("the error is not certified to be below its limit: " + unknown);
  ASSERT_NE(early, std::string::npos) << result.err;
  ASSERT_NE(late, std::string::npos) << result.err;
  EXPECT_LT(early, late);
  EXPECT_EQ(result.err.find("will not be certified", early + 20), std::string::npos) << "it is said once";
}

TEST(render_command_test, moments_are_channels_named_like_the_nested_integrator) {
  const TemporaryDirectory directory;
  const fs::path scene = write(directory / "moment.xml",
                               "<scene version=\"3.0.0\"><integrator type=\"moment\"><integrator type=\"path\" name=\"light\"/></integrator>"
                               "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><film type=\"hdrfilm\"/></sensor>"
                               "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter></scene>");
  const fs::path exr = directory / "a.exr";
  ASSERT_EQ(run_oclair({"render", scene.string(), "-o", exr.string(), "--spp", "3", "--size", "4x4"}).exit, 0);
  const ExrFile file = read_exr(exr);
  // CIE XYZ of linear sRGB (1, 2, 3), and its squares.
  const std::pair<const char*, double> expected[] = {{"light.X", 1.668882}, {"light.Y", 1.859498}, {"light.Z", 3.108401},
                                                     {"m2_light.X", 2.785167}, {"m2_light.Y", 3.457733}, {"m2_light.Z", 9.662157}};
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(file.channels.count(name)) << name;
    for (float v : file.channels.at(name)) EXPECT_NEAR(v, value, 1e-6 * value) << name;
  }
}

TEST(render_command_test, sampler_is_sobol_unless_asked_otherwise_and_is_named_in_the_header) {
  const TemporaryDirectory directory;
  const auto render = [&](std::vector<std::string> more) {
    const fs::path exr = directory / "a.exr";
    std::vector<std::string> arguments = {"render", (scenes / "lambert.xml").string(), "-o", exr.string(), "--spp", "2", "--size", "16x16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    return read_exr(exr);
  };
  const auto named = [](const ExrFile& file) { return std::get<std::string>(file.attributes.at("sampler")); };
  const ExrFile plain = render({}), sobol = render({"--sampler", "sobol"}), independent = render({"--sampler", "independent"});
  EXPECT_EQ(named(plain), "sobol");
  EXPECT_EQ(named(sobol), "sobol");
  EXPECT_EQ(named(independent), "independent");
  EXPECT_EQ(plain.channels.at("R"), sobol.channels.at("R"));
  EXPECT_NE(independent.channels.at("R"), sobol.channels.at("R"));
}

// Aluminium, whose reflectance Schlick's curve misses by some per cent at 50 to 60 degrees.
TEST(render_command_test, approximations_change_the_image_and_are_named_in_its_header) {
  const TemporaryDirectory directory;
  const auto scene = [&](const std::string& name, const std::string& bsdf) {
    return write(directory / (name + ".xml"),
                 "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>"
                 "<transform name=\"to_world\"><lookat origin=\"0 3 2\" target=\"0 0 0\" up=\"0 0 1\"/></transform></sensor>"
                 "<emitter type=\"constant\"/><shape type=\"rectangle\">" + bsdf + "</shape></scene>")
        .string();
  };
  const std::string metal = scene("metal", "<bsdf type=\"conductor\"><string name=\"material\" value=\"Al\"/></bsdf>");
  const std::string paint = scene("paint", "<bsdf type=\"roughdiffuse\"><boolean name=\"use_fast_approx\" value=\"true\"/></bsdf>");
  const auto render = [&](const std::string& file, std::vector<std::string> more) {
    const fs::path exr = directory / "a.exr";
    std::vector<std::string> arguments = {"render", file, "-o", exr.string(), "--spp", "1", "--size", "8x8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    return read_exr(exr);
  };
  const auto named = [](const ExrFile& file) { return std::get<std::string>(file.attributes.at("approximations")); };
  const ExrFile plain = render(metal, {}), exact = render(metal, {"--fresnel", "exact"}), schlick = render(metal, {"--fresnel", "schlick"});
  EXPECT_EQ(named(plain), "none");
  EXPECT_EQ(named(exact), "none");
  EXPECT_EQ(named(schlick), "fresnel=schlick");
  EXPECT_EQ(plain.channels.at("R"), exact.channels.at("R"));
  EXPECT_NE(exact.channels.at("R"), schlick.channels.at("R"));
  EXPECT_EQ(named(render(paint, {})), "oren_nayar=qualitative");
  EXPECT_EQ(named(render(paint, {"--fresnel", "schlick"})), "oren_nayar=qualitative");  // nothing there has a Fresnel term
}

TEST(render_command_test, arithmetic_in_double_gives_other_bits_and_is_named_in_the_header) {
  if (oclair::open_device().device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() == 0) GTEST_SKIP() << "no double precision";
  const TemporaryDirectory directory;
  const auto render = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", (scenes / "cornell.xml").string(), "-o", (directory / name).string(), "--spp", "1",
                                          "--size", "8x8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    return read_exr(directory / name);
  };
  const auto named = [](const ExrFile& file) { return std::get<std::string>(file.attributes.at("arithmetic")); };
  const ExrFile plain = render("a.exr", {}), single = render("b.exr", {"--arithmetic", "float"}),
                twin = render("c.exr", {"--arithmetic", "double", "--aov", "albedo"});
  EXPECT_EQ(named(plain), "float");
  EXPECT_EQ(named(single), "float");
  EXPECT_EQ(named(twin), "double");
  EXPECT_EQ(plain.channels.at("R"), single.channels.at("R"));
  EXPECT_NE(plain.channels.at("R"), twin.channels.at("R"));
}

TEST(render_command_test, info_says_what_the_scene_requires) {
  const ProgramResult result = run_oclair({"info", (scenes / "cornell-boxes.xml").string()});
  EXPECT_EQ(result.exit, 0) << result.err;
  for (const char* line : {"triangles           36", "lights              2", "DIFFUSE:", "TRIANGLES:", "TRIANGLE_LIGHTS:", "render in path.cl",
                           "nodes:", "triangle blocks:", "film: 16.0 MiB", "memory ", "per triangle "})
    EXPECT_NE(result.out.find(line), std::string::npos) << line << " is missing in\n" << result.out;
  for (const char* absent : {"MIRROR:", "SPHERES:", "normals:", "quadrics:", "moments:"})
    EXPECT_EQ(result.out.find(absent), std::string::npos) << absent;
}
