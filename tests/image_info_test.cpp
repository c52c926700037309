// What is told of OpenEXR files: of ours, of others', of broken ones.
#include "../host/image_info.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfTiledRgbaFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <functional>

#include "../host/error.h"
#include "../host/image.h"
#include "encoders.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using oclair::test::exr_bytes;
namespace fs = std::filesystem;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

ImagePart part_of(const std::string& name, const std::string& channel, const std::vector<float>& values) {
  return {name, {channel}, ValuesOfPixel<float>([&values](std::size_t pixel, std::span<float> v) { v[0] = values[pixel]; })};
}

// The most that was in use so far, KiB.
long peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// Its message, or "" if it is not refused.
std::string refusal(const fs::path& path) {
  try {
    read_image_info(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::scene);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find(path.string() + ": "), 0u) << error.what();
    return error.what();
  }
  return "";
}

const std::vector<float> colours = {1.0f, -2.0f, 0.5f, infinity, not_a_number, not_a_number};
const std::vector<float> grey(6, 0.25f);

void write_two_parts(const fs::path& path) {
  const ImagePart ids = {"ids", {"ids.id"}, ValuesOfPixel<std::uint32_t>([](std::size_t pixel, auto v) {
                           v[0] = 4294967290u + static_cast<std::uint32_t>(pixel);
                         })};
  write_exr(path, {640, 480, 100, 7, 3, 2}, {part_of("rgb", "R", colours), ids},
            {{"scene", "a\x1b[2J\n.xml"}, {"passes", 7}, {"seconds", 0.1f}});
}

}  // namespace

TEST(image_info_test, tells_parts_channels_ranges_and_attributes) {
  const TemporaryDirectory directory;
  write_two_parts(directory / "a.exr");
  const std::vector<PartInfo> parts = read_image_info(directory / "a.exr");
  ASSERT_EQ(parts.size(), 2u);
  const PartInfo& first = parts[0];
  EXPECT_EQ(first.name, "rgb");
  EXPECT_EQ(first.type, "scanlineimage");
  EXPECT_EQ(first.width, 3u);
  EXPECT_EQ(first.height, 2u);
  EXPECT_EQ(first.x, 100);
  EXPECT_EQ(first.y, 7);
  EXPECT_EQ(first.film_width, 640u);
  EXPECT_EQ(first.film_height, 480u);
  ASSERT_EQ(first.channels.size(), 1u);
  EXPECT_EQ(first.channels[0].name, "R");
  EXPECT_EQ(first.channels[0].type, "float");
  EXPECT_EQ(first.channels[0].min, -2.0);
  EXPECT_EQ(first.channels[0].max, 1.0);
  EXPECT_EQ(first.channels[0].mean, -0.5 / 3.0);
  EXPECT_EQ(first.channels[0].finite, 3u);
  EXPECT_EQ(first.channels[0].infinite, 1u);
  EXPECT_EQ(first.channels[0].nan, 2u);
  EXPECT_EQ(first.attributes, (std::vector<std::pair<std::string, std::string>>{
                                  {"chromaticities",
                                   "red 0.639999986 0.330000013 green 0.300000012 0.600000024 blue 0.150000006 "
                                   "0.0599999987 white 0.312700003 0.328999996"},
                                  {"passes", "7"},
                                  {"scene", "a?[2J?.xml"},  // nothing that would steer a terminal
                                  {"seconds", "0.100000001"}}));
  ASSERT_EQ(parts[1].channels.size(), 1u);
  EXPECT_EQ(parts[1].channels[0].type, "uint");
  EXPECT_EQ(parts[1].channels[0].min, 4294967290.0);
  EXPECT_EQ(parts[1].channels[0].max, 4294967295.0);
}

// Half floats, integers, a data window that begins at (-3, 5): written by OpenEXR itself.
TEST(image_info_test, tells_files_that_are_not_ours) {
  const TemporaryDirectory directory;
  put(directory / "a.exr",
      exr_bytes(4, 2, {{"G", Imf::HALF, {0, 1, 2, 3, 4, 5, 6, 7}}, {"id", Imf::UINT, {9, 9, 9, 9, 9, 9, 9, 1}}}));
  const std::vector<PartInfo> parts = read_image_info(directory / "a.exr");
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].name, "");
  EXPECT_EQ(parts[0].x, 0);  // its display window begins there too
  ASSERT_EQ(parts[0].channels.size(), 2u);
  EXPECT_EQ(parts[0].channels[0].type, "half");
  EXPECT_EQ(parts[0].channels[0].mean, 3.5);
  EXPECT_EQ(parts[0].channels[0].max, 7.0);
  EXPECT_EQ(parts[0].channels[1].min, 1.0);
  EXPECT_EQ(parts[0].channels[1].mean, 8.0);
}

// Chroma has a sample for each square of four pixels; that of grey is 0.
TEST(image_info_test, counts_the_samples_of_luminance_and_chroma) {
  const TemporaryDirectory directory;
  {
    Imf::RgbaOutputFile file((directory / "a.exr").c_str(), 300, 200, Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(300 * 200, Imf::Rgba(0.5f, 0.5f, 0.5f));
    file.setFrameBuffer(pixels.data(), 1, 300);
    file.writePixels(200);
  }
  const std::vector<PartInfo> parts = read_image_info(directory / "a.exr");
  ASSERT_EQ(parts.at(0).channels.size(), 3u);
  for (const ChannelInfo& channel : parts[0].channels) {
    const bool chroma = channel.name != "Y";
    EXPECT_EQ(channel.finite, chroma ? 150u * 100u : 300u * 200u) << channel.name;
    EXPECT_NEAR(channel.min, chroma ? 0.0 : 0.5, 1e-3) << channel.name;  // half floats
    EXPECT_NEAR(channel.max, chroma ? 0.0 : 0.5, 1e-3) << channel.name;
  }
}

TEST(image_info_test, reads_tiles) {
  const TemporaryDirectory directory;
  {
    Imf::TiledRgbaOutputFile file((directory / "a.exr").c_str(), 100, 70, 32, 16, Imf::ONE_LEVEL);
    std::vector<Imf::Rgba> pixels(100 * 70, Imf::Rgba(1.0f, 2.0f, 3.0f, 0.25f));
    pixels[42 * 100 + 99].r = 5.0f;
    file.setFrameBuffer(pixels.data(), 1, 100);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const PartInfo part = read_image_info(directory / "a.exr").at(0);
  EXPECT_EQ(part.type, "tiledimage");
  ASSERT_EQ(part.channels.size(), 4u);
  EXPECT_EQ(part.channels[0].mean, 0.25);
  EXPECT_EQ(part.channels[1].max, 3.0);
  EXPECT_EQ(part.channels[3].name, "R");
  EXPECT_EQ(part.channels[3].max, 5.0);
  EXPECT_EQ(part.channels[3].finite, 7000u);
  EXPECT_NEAR(part.channels[3].mean, 1.0 + 4.0 / 7000, 1e-12);
}

TEST(image_info_test, shows_the_header_of_deep_pixels) {
  const TemporaryDirectory directory;
  {
    Imf::Header header(4, 2);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    std::vector<unsigned> counts(8, 0);
    std::vector<float*> samples(8, nullptr);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
    buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float*), 4 * sizeof(float*), 4));
    Imf::DeepScanLineOutputFile file((directory / "a.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  const PartInfo part = read_image_info(directory / "a.exr").at(0);
  EXPECT_EQ(part.type, "deepscanline");
  EXPECT_EQ(part.width, 4u);
  ASSERT_EQ(part.channels.size(), 1u);
  EXPECT_EQ(part.channels[0].name, "Z");
  EXPECT_EQ(part.channels[0].finite, 0u);
}

TEST(image_info_test, a_file_is_an_image_by_what_it_holds) {
  const TemporaryDirectory directory;
  write_two_parts(directory / "scene.xml");
  put(directory / "a.exr", "<scene version=\"3.0.0\"/>");
  put(directory / "short", "\x76\x2f\x31");
  EXPECT_TRUE(is_exr(directory / "scene.xml"));
  EXPECT_FALSE(is_exr(directory / "a.exr"));
  EXPECT_FALSE(is_exr(directory / "short"));
  EXPECT_FALSE(is_exr(directory / "nowhere"));
  EXPECT_FALSE(is_exr("/dev/null"));
}

TEST(image_info_test, every_beginning_of_a_file_is_refused_on_one_line) {
  const TemporaryDirectory directory;
  write_two_parts(directory / "whole");
  const std::string whole = content(directory / "whole");
  ASSERT_EQ(refusal(directory / "whole"), "");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(directory / "a", whole.substr(0, length));
    EXPECT_NE(refusal(directory / "a"), "") << length << " of " << whole.size();
  }
}

// Some changes make another valid file; none may end the process or take much memory.
TEST(image_info_test, no_changed_byte_does_harm) {
  const TemporaryDirectory directory;
  write_two_parts(directory / "two");
  put(directory / "one", exr_bytes(4, 2, {{"G", Imf::HALF, std::vector<float>(8, 1.0f)}}));
  std::size_t refused = 0;
  const long before = peak_memory();
  for (const char* name : {"two", "one"}) {
    const std::string whole = content(directory / name);
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const char changed : {'\x01', '\x7f', static_cast<char>(whole[at] ^ 0x80)}) {
        std::string bytes = whole;
        bytes[at] = changed;
        put(directory / "a", bytes);
        refused += refusal(directory / "a") != "";
      }
  }
  EXPECT_GT(refused, 100u);
  EXPECT_LT(peak_memory() - before, 64 * 1024);
}

// An attribute of 2 GiB, a row of 2^31 pixels, a string in a list of strings that is longer than the list.
TEST(image_info_test, sizes_that_are_claimed_are_not_believed) {
  const TemporaryDirectory directory;
  write_exr(directory / "whole", {3, 2, 0, 0, 3, 2}, {part_of("", "Y", grey)}, {{"text", "1234"}});
  const std::string whole = content(directory / "whole");
  const auto changed = [&](const std::string& after, std::size_t skip, const std::string& bytes) {
    std::string file = whole;
    const std::size_t at = file.find(after);
    EXPECT_NE(at, std::string::npos);
    file.replace(at + after.size() + skip, bytes.size(), bytes);
    put(directory / "a", file);
    const long before = peak_memory();
    const std::string message = refusal(directory / "a");
    EXPECT_LT(peak_memory() - before, 64 * 1024) << message;
    return message;
  };
  using std::string_literals::operator""s;
  EXPECT_NE(changed("text\0string\0"s, 0, "\xff\xff\xff\x7f").find("it breaks off in its header"), std::string::npos);
  EXPECT_NE(changed("text\0string\0"s, 0, "\xff\xff\xff\xff").find("negative size"), std::string::npos);
  EXPECT_NE(changed("dataWindow\0box2i\0"s, 4 + 8, "\xf0\xff\xff\x3f"), "");
  EXPECT_NE(changed("dataWindow\0box2i\0"s, 4 + 12, "\xf0\xff\xff\x3f"), "");
  // The string "1234" becomes a list with one string of 2 GiB; the name of its type is longer, so that something else goes.
  std::string file = whole;
  const std::size_t at = file.find("text\0string\0"s);
  file.replace(at, "text\0string\0"s.size() + 4 + 4, "t\0stringvector\0\4\0\0\0\xff\xff\xff\x7f"s);
  put(directory / "a", file);
  EXPECT_NE(refusal(directory / "a").find("a string in its header is too long"), std::string::npos);
}

TEST(image_info_test, the_command_prints_an_image_and_refuses_a_broken_one) {
  const TemporaryDirectory directory;
  write_two_parts(directory / "a.exr");
  const ProgramResult result = run_oclair({"info", (directory / "a.exr").string()});
  EXPECT_EQ(result.exit, 0) << result.err;
  for (const char* line :
       {"part                rgb: 3x2 at 100,7 of 640x480, scanlineimage\n",
        "channel             R: float, from -2 to 1, mean -0.166666667, 1 infinite, 2 not a number\n",
        "channel             ids.id: uint, from 4294967290 to 4294967295, mean 4294967292\n", "passes              7\n"})
    EXPECT_NE(result.out.find(line), std::string::npos) << line << " is missing in\n" << result.out;
  put(directory / "b.exr", content(directory / "a.exr").substr(0, 500));
  const ProgramResult broken = run_oclair({"info", (directory / "b.exr").string()});
  EXPECT_EQ(broken.exit, 3);
  EXPECT_EQ(broken.out, "");
  EXPECT_NE(broken.err.find("b.exr: "), std::string::npos);
  EXPECT_NE(broken.err.find("expected an OpenEXR file that is whole\n"), std::string::npos) << broken.err;
}
