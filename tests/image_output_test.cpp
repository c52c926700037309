// What the program writes into its images beside the colour: layers, and the header.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "exr_reader.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const fs::path scenes = fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes";

ProgramResult render(const fs::path& image, const Arguments& more) {
  Arguments arguments = {"render", (scenes / "furnace.xml").string(), "-o", image.string(), "--size", "16x8"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_oclair(arguments);
}

std::string text(const ExrFile& file, const std::string& name) {
  const auto found = file.attributes.find(name);
  return found == file.attributes.end() ? "" : std::get<std::string>(found->second);
}

// While it lives SOURCE_DATE_EPOCH has that value, for the program too.
class SourceDate {
 public:
  explicit SourceDate(const char* value) { setenv("SOURCE_DATE_EPOCH", value, 1); }
  ~SourceDate() { unsetenv("SOURCE_DATE_EPOCH"); }
};

}  // namespace

TEST(image_output_test, layers_have_parts_and_channels_of_their_names) {
  const TemporaryDirectory directory;
  ASSERT_EQ(render(directory / "a.exr", {"--spp", "32", "--aov", "primitive,depth,albedo,uv,normal"}).exit, 0);
  std::vector<std::string> parts, channels;
  for (const ExrPart& part : read_exr_parts(directory / "a.exr")) {
    parts.push_back(part.name);
    for (const auto& channel : part.floats) channels.push_back(channel.first);
    for (const auto& channel : part.integers) channels.push_back(channel.first + " uint");
    EXPECT_EQ(part.window.crop_width, 16u);
  }
  EXPECT_EQ(parts, (std::vector<std::string>{"rgb", "standardError", "albedo", "normal", "depth", "uv", "primitive"}));
  EXPECT_EQ(channels, (std::vector<std::string>{"B", "G", "R", "standardError.B", "standardError.G", "standardError.R",
                                                "albedo.B", "albedo.G", "albedo.R", "normal.X", "normal.Y", "normal.Z",
                                                "depth.Z", "uv.U", "uv.V", "primitive.id uint"}));
}

TEST(image_output_test, layers_change_no_bit_of_the_colour) {
  const TemporaryDirectory directory;
  ASSERT_EQ(render(directory / "a.exr", {"--spp", "2"}).exit, 0);
  ASSERT_EQ(render(directory / "b.exr", {"--spp", "2", "--aov", "uv,normal"}).exit, 0);
  EXPECT_EQ(read_exr(directory / "a.exr").channels, read_exr(directory / "b.exr").channels);
}

TEST(image_output_test, unknown_layers_are_a_usage_error) {
  for (const char* given : {"", "colour", "albedo,", "albedo,,uv", "Albedo"}) {
    const ProgramResult result = run_oclair({"render", "a.xml", "--aov", given});
    EXPECT_EQ(result.exit, 2) << given;
    EXPECT_NE(result.err.find("--aov"), std::string::npos) << result.err;
  }
}

TEST(image_output_test, with_a_date_equal_runs_write_equal_bytes_whatever_their_command_lines) {
  const TemporaryDirectory directory;
  const SourceDate date("1700000000");
  ASSERT_EQ(render(directory / "a.exr", {"--spp", "32", "--aov", "albedo"}).exit, 0);
  ASSERT_EQ(render(directory / "b.exr", {"--aov", "albedo", "--spp", "32"}).exit, 0);
  EXPECT_EQ(content(directory / "a.exr"), content(directory / "b.exr"));
  EXPECT_EQ(text(read_exr(directory / "a.exr"), "capDate"), "2023:11:14 22:13:20");
}

TEST(image_output_test, the_header_says_how_the_image_was_made) {
  const TemporaryDirectory directory;
  const fs::path image = directory / "it's a.exr";
  ASSERT_EQ(render(image, {"--spp", "32", "--seed", "5"}).exit, 0);
  const ExrFile file = read_exr(image);
  const std::string quoted = "'" + (directory / "it").string() + "'\\''s a.exr'";
  EXPECT_EQ(text(file, "commandLine"),
            "oclair render " + (scenes / "furnace.xml").string() + " -o " + quoted + " --size 16x8 --spp 32 --seed 5");
  EXPECT_EQ(text(file, "seed"), "5");
  EXPECT_EQ(text(file, "sampleRanges"), "0:32");
  EXPECT_EQ(text(file, "samplesPerPixel"), "32");
  EXPECT_EQ(text(file, "rejectedSamples"), "0");
  EXPECT_NE(text(file, "secondsPerPhase").find("passes"), std::string::npos);
  for (const char* name : {"software", "sceneHash", "sampler", "features", "device", "driver"})
    EXPECT_NE(text(file, name), "") << name;
  EXPECT_EQ(file.attributes.count("capDate"), 0u);
}

TEST(image_output_test, a_wrong_date_is_refused_before_anything_is_rendered) {
  const TemporaryDirectory directory;
  const SourceDate date("yesterday");
  const ProgramResult result = render(directory / "a.exr", {"--spp", "1"});
  EXPECT_EQ(result.exit, 2);
  EXPECT_NE(result.err.find("SOURCE_DATE_EPOCH 'yesterday': expected seconds since 1970"), std::string::npos) << result.err;
  EXPECT_EQ(directory.names().size(), 0u);
}

TEST(image_output_test, info_tells_what_was_written) {
  const TemporaryDirectory directory;
  ASSERT_EQ(render(directory / "a.exr", {"--spp", "32", "--aov", "depth"}).exit, 0);
  const ProgramResult result = run_oclair({"info", (directory / "a.exr").string()});
  EXPECT_EQ(result.exit, 0) << result.err;
  for (const char* line : {"part                rgb: 16x8, scanlineimage\n", "channel             R: float, from ",
                           "channel             standardError.G: float, from ", "channel             depth.Z: float, from ",
                           "samplesPerPixel     32\n", "estimatedError      "})
    EXPECT_NE(result.out.find(line), std::string::npos) << line << " is missing in\n" << result.out;
}
