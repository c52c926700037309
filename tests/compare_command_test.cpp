// `oclair compare`: what it says of two files, and with which exit code.
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfPartType.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "../host/image.h"
#include "encoders.h"
#include "exr_reader.h"
#include "files.h"
#include "png_reader.h"
#include "program.h"
#include "random.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using oclair::test::exr_bytes;
namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

constexpr float infinity = std::numeric_limits<float>::infinity();

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Values, and errors if there are any, pixel by pixel in the order of the channels.
struct Picture {
  ImageWindow window{4, 2, 0, 0, 4, 2};
  std::vector<std::string> channels = {"R", "G", "B"};
  std::vector<float> values, errors;
  ImageAttributes attributes{};
};

ImagePart part_of(const std::string& name, const std::string& prefix, const Picture& picture,
                  const std::vector<float>& values) {
  ImagePart part{name, {}, {}};
  for (const std::string& channel : picture.channels) part.channels.push_back(prefix + channel);
  const std::size_t count = picture.channels.size();
  part.values = ValuesOfPixel<float>([&values, count](std::size_t pixel, std::span<float> v) {
    for (std::size_t c = 0; c < count; ++c) v[c] = values[pixel * count + c];
  });
  return part;
}

void write(const fs::path& path, const Picture& picture) {
  std::vector<ImagePart> parts = {part_of("colour", "", picture, picture.values)};
  if (!picture.errors.empty()) parts.push_back(part_of("standardError", "standardError.", picture, picture.errors));
  write_exr(path, picture.window, parts, picture.attributes);
}

// 1, 2, ..., 24, times a factor.
Picture ramp(float factor = 1.0f) {
  Picture picture;
  for (int i = 1; i <= 24; ++i) picture.values.push_back(factor * static_cast<float>(i));
  return picture;
}

// 64x64 pixels of four replicas whose means are equally distributed in 0 to 2 times the factor.
Picture noise(std::uint64_t seed, double factor = 1.0) {
  test::Random random(seed);
  Picture picture;
  picture.window = {64, 64, 0, 0, 64, 64};
  for (int i = 0; i < 3 * 64 * 64; ++i) {
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double x = factor * 2.0 * random.unit();
      sum += x;
      squares += x * x;
    }
    picture.values.push_back(static_cast<float>(sum / 4.0));
    picture.errors.push_back(static_cast<float>(std::sqrt((squares - sum * sum / 4.0) / 12.0)));
  }
  picture.attributes = {{"sampleRanges", "0:64"}, {"seed", std::to_string(seed)}, {"sampler", "sobol"}};
  return picture;
}

class compare_command_test : public testing::Test {
 protected:
  ProgramResult compare_them(const Arguments& more = {}) const {
    Arguments arguments = {"compare", a, b};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_oclair(arguments);
  }

  Json json() const {
    const ProgramResult result = compare_them({"--json", "-"});
    return Json::parse(result.out);
  }

  // On one line that begins with the file.
  void expect_refused(const ProgramResult& result, int exit, const std::string& file, const std::string& part) const {
    EXPECT_EQ(result.exit, exit) << part;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.find("oclair: " + file), 0u) << result.err;
    EXPECT_TRUE(contains(result.err, part)) << part << " is missing in:\n" << result.err;
    EXPECT_TRUE(contains(result.err, ", expected ")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  const TemporaryDirectory directory;
  const std::string a = directory / "a.exr", b = directory / "b.exr", r = directory / "r.exr", png = directory / "d.png",
                    json_file = directory / "d.json";
};

TEST_F(compare_command_test, renders_of_one_picture_are_not_different) {
  write(a, noise(1));
  write(b, noise(2));
  const ProgramResult result = compare_them();
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(contains(result.out, "\nno significant difference: p ")) << result.out;
  EXPECT_TRUE(contains(result.out, ", false-alarm rate at most 0.001\n")) << result.out;
}

// 12288 values of deviation 0.58 / 2: 3 % of their mean of 1 is 8 deviations of the mean difference in each channel.
TEST_F(compare_command_test, a_brighter_picture_is_different_and_exits_with_7) {
  write(a, noise(1, 1.03));
  write(b, noise(2));
  const ProgramResult result = compare_them({"--alpha", "1e-6"});
  EXPECT_EQ(result.exit, 7) << result.out;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(contains(result.out, "\nthey differ significantly: p ")) << result.out;
  EXPECT_TRUE(contains(result.out, ", false-alarm rate at most 1e-06\n")) << result.out;
  const ProgramResult strict = compare_them({"--alpha", "1e-300"});
  EXPECT_EQ(strict.exit, 0);
}

TEST_F(compare_command_test, a_file_is_not_different_from_itself) {
  write(a, noise(1));
  write(b, noise(1));
  const ProgramResult result = compare_them();
  EXPECT_EQ(result.exit, 0);
  EXPECT_TRUE(contains(result.out, "A - B: signed mean 0 (of ")) << result.out;
  EXPECT_TRUE(contains(result.out, "since the images share random numbers\n")) << result.out;
}

TEST_F(compare_command_test, without_standard_errors_there_are_figures_and_no_test) {
  write(a, ramp());
  write(b, ramp(2.0f));
  const ProgramResult result = compare_them();
  EXPECT_EQ(result.exit, 0);
  EXPECT_TRUE(contains(result.out, "maximum 24 in B at 3,1\n")) << result.out;
  EXPECT_TRUE(contains(result.out, "no test is possible: no standard errors of both images\n")) << result.out;
}

// x = k and r = 2 k for k from 1 to 24: mean k 25/2, mean k^2 = 25 49 / 6, |x - r| / (|x| + |r|) = 1/3.
TEST_F(compare_command_test, the_figures_have_their_closed_forms) {
  write(a, ramp());
  write(b, ramp(2.0f));
  double relative = 0.0;
  for (int k = 1; k <= 24; ++k) relative += k * k / (4.0 * k * k + 0.01) / 24.0;
  const Json difference = json().at("difference");
  EXPECT_EQ(difference.at("values"), 24);
  EXPECT_EQ(difference.at("notFinite"), 0);
  EXPECT_EQ(difference.at("mean"), 25.0);
  EXPECT_EQ(difference.at("signedMean"), -12.5);
  EXPECT_NEAR(difference.at("mse"), 25.0 * 49.0 / 6.0, 1e-12);
  EXPECT_NEAR(difference.at("relMSE"), relative, 1e-14);
  EXPECT_NEAR(difference.at("smape"), 1.0 / 3.0, 1e-14);
  EXPECT_EQ(difference.at("maximum"), 24.0);
  EXPECT_EQ(difference.at("maximumAt"), (Json{{"x", 3}, {"y", 1}, {"channel", "B"}}));
}

TEST_F(compare_command_test, a_crop_is_placed_in_its_film) {
  Picture picture = ramp();
  picture.window = {640, 480, 100, 7, 4, 2};
  write(a, picture);
  picture.values[7] += 1.0f;  // G of the third pixel
  write(b, picture);
  EXPECT_TRUE(contains(compare_them().out, "maximum 1 in G at 102,7\n"));
}

TEST_F(compare_command_test, luminance_alone_has_one_value_a_pixel_and_xyz_three) {
  Picture picture = ramp();
  picture.channels = {"Y"};
  picture.values.resize(8);
  write(a, picture);
  picture.values[5] = 106.0f;
  write(b, picture);
  const ProgramResult result = compare_them({"--png", png});
  EXPECT_TRUE(contains(result.out, "maximum 100 in Y at 1,1\n")) << result.out;
  EXPECT_EQ(json().at("difference").at("values"), 8);
  EXPECT_EQ(json().at("difference").at("signedMean"), -12.5);
  EXPECT_EQ(read_png(png)[3 * 5 + 2], 188);  // blue
  picture = ramp();
  picture.channels = {"X", "Y", "Z"};
  write(a, picture);
  picture.values[3 * 5] += 1.0f;
  write(b, picture);
  EXPECT_TRUE(contains(compare_them({"--png", png}).out, "maximum 1 in X at 1,1\n"));
  EXPECT_EQ(json().at("difference").at("values"), 24);
  EXPECT_EQ(read_png(png)[3 * 5 + 2], 225);  // of X nothing is seen
}

TEST_F(compare_command_test, both_are_judged_by_the_reference) {
  write(r, ramp());
  Picture picture = ramp();
  for (float& value : picture.values) value += 0.5f;
  write(a, picture);
  for (float& value : picture.values) value -= 0.75f;
  write(b, picture);
  const ProgramResult result = compare_them({"--reference", r, "--json", json_file});
  EXPECT_EQ(result.exit, 0);
  const Json found = Json::parse(content(json_file));
  EXPECT_EQ(found.at("reference"), r);
  EXPECT_EQ(found.at("errorOfA").at("mse"), 0.25);
  EXPECT_EQ(found.at("errorOfA").at("signedMean"), 0.5);
  EXPECT_EQ(found.at("errorOfB").at("mse"), 0.0625);
  EXPECT_EQ(found.at("errorOfB").at("signedMean"), -0.25);
  EXPECT_TRUE(contains(result.out, "A - reference: signed mean 0.5 (of 12.5), MSE 0.25,")) << result.out;
  EXPECT_TRUE(contains(result.out, "\nMSE of A over that of B: 4\n")) << result.out;
}

TEST_F(compare_command_test, json_goes_to_a_file_beside_the_lines_or_alone_to_standard_output) {
  write(a, noise(1));
  write(b, noise(2, 1.1));
  const ProgramResult to_file = compare_them({"--json", json_file}), alone = compare_them({"--json", "-"});
  EXPECT_EQ(to_file.exit, 7);
  EXPECT_EQ(alone.exit, 7);
  EXPECT_EQ(to_file.err, "");
  EXPECT_EQ(alone.err, to_file.out);
  EXPECT_EQ(alone.out, content(json_file));
  const Json found = Json::parse(alone.out);
  EXPECT_EQ(found.at("a"), a);
  const Json equality = found.at("equality");
  EXPECT_EQ(equality.at("differs"), true);
  EXPECT_EQ(equality.at("alpha"), 0.001);
  EXPECT_EQ(equality.at("tests").size(), 4u);
  EXPECT_EQ(equality.at("tests")[0].at("name"), "mean");
  EXPECT_LT(equality.at("tests")[0].at("statistic"), 0.0);
  EXPECT_LT(equality.at("p"), 1e-3);
  EXPECT_EQ(equality.count("approximate"), 0u);
  EXPECT_GT(found.at("z").at("p99"), found.at("z").at("p50"));
}

// Differences of luminance 1, -1 and half of it, with the rest equal; of four that differ the 99th percentile is the
// largest. Half of the way from grey is 225 - 27.5, 225 - 112.5, 225 - 99.5, which are halves: rounded either way.
TEST_F(compare_command_test, the_picture_is_red_where_a_is_brighter_and_blue_where_b_is) {
  Picture picture = ramp();
  write(b, picture);
  for (std::size_t c = 0; c < 3; ++c) {
    picture.values[c] += 1.0f;
    picture.values[3 + c] -= 1.0f;
    picture.values[6 + c] += 0.5f;
  }
  picture.values[9] = infinity;
  write(a, picture);
  const ProgramResult result = compare_them({"--png", png});
  EXPECT_EQ(result.exit, 0);
  EXPECT_TRUE(contains(result.out, png + ": red is A - B = 1, blue -1\n")) << result.out;
  EXPECT_TRUE(contains(result.out, "A - B: 1 of 24 values are not finite, and left out\n")) << result.out;
  const std::vector<std::uint8_t> bytes = read_png(png);
  const std::vector<std::uint8_t> two(bytes.begin(), bytes.begin() + 6), rest(bytes.begin() + 9, bytes.end());
  EXPECT_EQ(two, (std::vector<std::uint8_t>{170, 0, 26, 0, 70, 188}));
  EXPECT_NEAR(bytes[6], 197.5, 0.5);
  EXPECT_NEAR(bytes[7], 112.5, 0.5);
  EXPECT_NEAR(bytes[8], 125.5, 0.5);
  EXPECT_EQ(rest, (std::vector<std::uint8_t>{0, 0, 0, 225, 225, 225, 225, 225, 225, 225, 225, 225, 225, 225, 225}));
}

TEST_F(compare_command_test, layers_change_nothing) {
  Picture picture = noise(1);
  write(a, picture);
  write(b, noise(2));
  const std::string plain = compare_them().out;
  const std::vector<float> albedo(picture.values.size(), 0.5f);
  write_exr(a, picture.window,
            {part_of("colour", "", picture, picture.values), part_of("albedo", "albedo.", picture, albedo),
             part_of("standardError", "standardError.", picture, picture.errors)},
            picture.attributes);
  EXPECT_EQ(compare_them().out, plain);
  // Standard errors as a layer of the only part.
  ImagePart both = part_of("", "", picture, picture.values);
  for (const char* channel : {"standardError.R", "standardError.G", "standardError.B"}) both.channels.push_back(channel);
  both.values = ValuesOfPixel<float>([&picture](std::size_t pixel, std::span<float> v) {
    for (std::size_t c = 0; c < 3; ++c) {
      v[c] = picture.values[3 * pixel + c];
      v[3 + c] = picture.errors[3 * pixel + c];
    }
  });
  write_exr(a, picture.window, {both}, picture.attributes);
  EXPECT_EQ(compare_them().out, plain);
}

TEST_F(compare_command_test, sample_ranges_that_are_none_are_not_known) {
  write(b, noise(2));
  for (const char* ranges : {"", "64", "0:64:", "0:32 16:32", "-16:64", "0:99999999999999999999", "0:64 x"}) {
    Picture picture = noise(1);
    picture.attributes[0].second = ranges;
    write(a, picture);
    const ProgramResult result = compare_them();
    EXPECT_EQ(result.exit, 0) << ranges;
    EXPECT_TRUE(contains(result.out, "since a header does not say which samples there are\n")) << ranges << result.out;
  }
}

TEST_F(compare_command_test, images_that_cannot_be_compared_are_refused) {
  write(a, ramp());
  Picture picture = ramp();
  picture.window = {2, 4, 0, 0, 2, 4};
  write(b, picture);
  expect_refused(compare_them(), 3, b, "has 2x4 pixels, expected 4x2 pixels as " + a + " has");
  picture.window = {8, 8, 1, 3, 4, 2};
  write(b, picture);
  expect_refused(compare_them(), 3, b, "has 4x2 pixels at 1,3, expected 4x2 pixels as");
  picture = ramp();
  picture.channels = {"Y"};
  write(b, picture);
  expect_refused(compare_them(), 3, b, "has the channels Y, expected R, G, B as");
  write(b, ramp());
  write(r, picture);
  expect_refused(compare_them({"--reference", r}), 3, r, "has the channels Y, expected R, G, B as");
  picture.channels = {"A"};
  write(b, picture);
  expect_refused(compare_them(), 3, b, "its first part has the channels A, not R, G, B or X, Y, Z or Y");
}

TEST_F(compare_command_test, what_is_no_whole_image_is_refused) {
  write(a, noise(1));
  expect_refused(compare_them(), 3, b, "it cannot be read");
  put(b, "<scene/>");
  expect_refused(compare_them(), 3, b, "it does not begin as an OpenEXR file does");
  const std::string whole = content(a);
  for (std::size_t part = 0; part < 20; ++part) {
    put(b, whole.substr(0, whole.size() * part / 20));
    expect_refused(compare_them(), 3, b, "expected an OpenEXR image that is whole");
  }
  fs::remove(b);
  fs::create_directory(b);
  expect_refused(compare_them(), 3, b, "it is not a regular file");
  fs::remove(b);
  ASSERT_EQ(mkfifo(b.c_str(), 0600), 0);  // nobody writes to it: opening it would wait for ever
  expect_refused(compare_them(), 3, b, "it is not a regular file");
}

TEST_F(compare_command_test, deep_pixels_are_refused) {
  write(a, ramp());
  Imf::Header header(4, 2);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  {
    std::vector<unsigned> counts(8, 0);
    std::vector<float*> samples(8, nullptr);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
    buffer.insert(
        "Y", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float*), 4 * sizeof(float*), 4));
    Imf::DeepScanLineOutputFile file(b.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  expect_refused(compare_them(), 3, b, "its pixels are deep");
}

// Of half floats, with a data window that begins at (-3, 5): written by OpenEXR itself.
TEST_F(compare_command_test, files_that_are_not_ours_are_compared) {
  std::vector<float> values(8);
  for (std::size_t i = 0; i < 8; ++i) values[i] = static_cast<float>(i);
  const auto grey = [&](const std::vector<float>& y) {
    return exr_bytes(4, 2, {{"Y", Imf::HALF, y}, {"id", Imf::UINT, values}});
  };
  put(a, grey(values));
  values[6] = 10.0f;
  put(b, grey(values));
  const ProgramResult result = compare_them();
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "maximum 4 in Y at 2,1\n")) << result.out;
}

// A changed byte makes another image or a broken one; nothing else may come of it.
TEST_F(compare_command_test, no_changed_byte_does_harm) {
  Picture picture = ramp();
  picture.errors.assign(24, 0.25f);
  picture.attributes = {{"sampleRanges", "0:64"}, {"seed", "1"}};
  write(a, picture);
  const std::string whole = content(a);
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x81);
    put(b, bytes);
    const ProgramResult result = compare_them();
    EXPECT_TRUE(result.exit == 0 || result.exit == 3 || result.exit == 7) << at << ": " << result.exit << result.err;
    EXPECT_LE(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

// B is broken as well: it has not been read when the output is refused.
TEST_F(compare_command_test, outputs_that_cannot_be_written_are_refused_before_the_images_are_read) {
  write(a, ramp());
  put(b, "broken");
  const std::string none = directory / "none" / "x";
  expect_refused(compare_them({"--png", none + ".png"}), 1, none + ".png", "cannot be created: No such file or directory");
  expect_refused(compare_them({"--json", none}), 1, none, "cannot be created: No such file or directory");
  fs::create_directory(png);
  expect_refused(compare_them({"--png", png}), 1, png, "is a directory");
}

TEST_F(compare_command_test, a_full_standard_output_is_a_failure_of_output) {
  write(a, ramp());
  write(b, ramp());
  EXPECT_EQ(run_oclair_into("/dev/full", {"compare", a, b}).exit, 1);
}

TEST_F(compare_command_test, images_are_never_written_over) {
  write(a, ramp());
  const std::string before = content(a), image = directory / "a.png";
  fs::rename(a, image);
  expect_refused(run_oclair({"compare", image, image, "--png", image}), 2, image, "is another output or an input");
  expect_refused(run_oclair({"compare", image, image, "--json", image}), 2, image, "is another output or an input");
  expect_refused(run_oclair({"compare", image, image, "--json", png, "--png", png}), 2, png,
                 "is another output or an input");
  expect_refused(run_oclair({"compare", b, b, "--reference", image, "--json", image}), 2, image,
                 "is another output or an input");
  EXPECT_EQ(content(image), before);
}

TEST_F(compare_command_test, a_wrong_command_line_exits_with_2) {
  const std::pair<Arguments, std::string> errors[] = {
      {{"compare"}, "A is required"},
      {{"compare", "a.exr"}, "B is required"},
      {{"compare", "a.exr", "b.exr", "c.exr"}, "c.exr"},
      {{"compare", "a.exr", "b.exr", "--alpha", "0"}, "--alpha '0': expected a number between 0 and 1"},
      {{"compare", "a.exr", "b.exr", "--alpha", "nan"}, "--alpha 'nan': expected a number between 0 and 1"},
      {{"compare", "a.exr", "b.exr", "--png", "d.exr"}, "--png 'd.exr': expected a name in .png"}};
  for (const auto& [arguments, message] : errors) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 2) << message;
    EXPECT_EQ(result.out, "") << message;
    EXPECT_TRUE(contains(result.err, message)) << result.err << "expected: " << message;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
