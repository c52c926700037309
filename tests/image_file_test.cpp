#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "../host/error.h"
#include "../host/image.h"
#include "exr_reader.h"
#include "extremes.h"
#include "faults.h"
#include "files.h"
#include "png_reader.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using oclair::test::record_law;
namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

std::vector<std::uint32_t> bits(std::span<const float> values, std::size_t stride = 1) {
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < values.size(); i += stride) result.push_back(std::bit_cast<std::uint32_t>(values[i]));
  return result;
}

// One value for each pixel, rows from top to bottom: values[pixel * stride].
struct PixelValues {
  std::span<const float> values;
  std::size_t stride = 1;
};

// A part of float channels with these values.
ImagePart planes(const std::string& name, const std::vector<std::pair<std::string, PixelValues>>& channels) {
  ImagePart part{name, {}, {}};
  for (const auto& channel : channels) part.channels.push_back(channel.first);
  part.values = ValuesOfPixel<float>([channels](std::size_t pixel, std::span<float> values) {
    for (std::size_t c = 0; c < channels.size(); ++c) values[c] = channels[c].second.values[pixel * channels[c].second.stride];
  });
  return part;
}

RgbOfPixels picture(const std::array<PixelValues, 3>& channels) {
  return [channels](std::size_t first, std::span<float> rgb) {
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      const PixelValues& channel = channels[i % 3];
      rgb[i] = channel.values[(first + i / 3) * channel.stride];
    }
  };
}

constexpr ImageWindow window_3_by_2 = {3, 2, 0, 0, 3, 2};

// Values of which no two neighbours are alike, so that compression cannot make the file small.
std::vector<float> noise(std::size_t count) {
  std::vector<float> values(count);
  std::uint32_t state = 1;
  for (float& value : values) value = static_cast<float>((state = state * 747796405u + 2891336453u) >> 8);
  return values;
}

void write_noise_exr(const fs::path& path) {
  const std::vector<float> values = noise(256 * 256);
  write_exr(path, {256, 256, 0, 0, 256, 256}, {planes("", {{"Y", {values}}})});
}

void write_noise_png(const fs::path& path) {
  std::vector<float> values = noise(256 * 256);
  for (float& value : values) value = std::ldexp(value, -24);
  write_png(path, 256, 256, picture({PixelValues{values}, {values}, {values}}));
}

using Writer = void (*)(const fs::path&);
constexpr Writer writers[] = {write_noise_exr, write_noise_png};

std::string message_of_failure(Writer write, const fs::path& path) {
  try {
    write(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    return error.what();
  }
  ADD_FAILURE() << path << " was written";
  return "";
}

TEST(image_file_test, exr_keeps_every_bit_of_every_float) {
  const TemporaryDirectory directory;
  const std::vector<float> values = {infinity, -infinity, not_a_number, 1e30f, 65520.0f, -0.0f};
  const std::vector<float> smallest = {1e-45f, 1e-38f, -1e-45f, 3.4e38f, 0.1f, 1.0f};
  write_exr(directory / "a.exr", window_3_by_2, {planes("", {{"Y", {values}}, {"Z", {smallest}}})});
  const ExrFile file = read_exr(directory / "a.exr");
  EXPECT_TRUE(file.is_float);
  EXPECT_EQ(bits(file.channels.at("Y")), bits(values));
  EXPECT_EQ(bits(file.channels.at("Z")), bits(smallest));
  record_law("X50");
}

TEST(image_file_test, exr_channels_keep_their_values_whatever_their_order) {
  const TemporaryDirectory directory;
  const std::vector<float> rgb = noise(3 * 6);
  const std::span<const float> all = rgb;
  write_exr(directory / "a.exr", window_3_by_2,
            {planes("", {{"R", {all, 3}}, {"G", {all.subspan(1), 3}}, {"B", {all.subspan(2), 3}}})});
  const ExrFile file = read_exr(directory / "a.exr");
  EXPECT_EQ(bits(file.channels.at("R")), bits(all, 3));
  EXPECT_EQ(bits(file.channels.at("G")), bits(all.subspan(1), 3));
  EXPECT_EQ(bits(file.channels.at("B")), bits(all.subspan(2), 3));
}

// Two blocks of rows and a bit, wide enough that several threads make the values.
TEST(image_file_test, exr_parts_keep_their_order_their_types_and_every_bit) {
  const TemporaryDirectory directory;
  constexpr unsigned width = 301, height = 131;
  std::vector<float> grey = noise(width * height);
  grey[7] = not_a_number;
  std::vector<std::uint32_t> numbers(2 * width * height);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = ~static_cast<std::uint32_t>(i * 2654435761u);
  const ImagePart identities = {"ids", {"ids.b", "ids.a"}, ValuesOfPixel<std::uint32_t>([&](std::size_t pixel, auto values) {
                                  values[0] = numbers[2 * pixel];
                                  values[1] = numbers[2 * pixel + 1];
                                })};
  write_exr(directory / "a.exr", {640, 480, 100, 7, width, height},
            {planes("grey", {{"Y", {grey}}}), identities, planes("depth", {{"depth.Z", {grey}}})}, {{"scene", "a.xml"}});
  const std::vector<ExrPart> parts = read_exr_parts(directory / "a.exr");
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ((Names{parts[0].name, parts[1].name, parts[2].name}), (Names{"grey", "ids", "depth"}));
  EXPECT_EQ(bits(parts[0].floats.at("Y")), bits(grey));
  EXPECT_EQ(bits(parts[2].floats.at("depth.Z")), bits(grey));
  for (std::size_t c : {0u, 1u}) {
    const std::vector<std::uint32_t>& plane = parts[1].integers.at(c == 0 ? "ids.b" : "ids.a");
    ASSERT_EQ(plane.size(), width * height);
    for (std::size_t i = 0; i < plane.size(); ++i) ASSERT_EQ(plane[i], numbers[2 * i + c]) << i;
  }
  EXPECT_EQ(parts[0].floats.size() + parts[1].floats.size() + parts[2].floats.size(), 2u);
  EXPECT_EQ(parts[0].integers.size() + parts[1].integers.size() + parts[2].integers.size(), 2u);
  for (const ExrPart& part : parts) {
    EXPECT_EQ(part.window.film_width, 640u);
    EXPECT_EQ(part.window.crop_x, 100u);
    EXPECT_EQ(part.window.crop_height, height);
    EXPECT_EQ(part.attributes, part.name == "grey" ? 1u : 0u);
  }
}

TEST(image_file_test, who_knows_nothing_of_parts_reads_the_first) {
  const TemporaryDirectory directory;
  const std::vector<float> values = noise(6), others = noise(12);
  write_exr(directory / "a.exr", window_3_by_2,
            {planes("grey", {{"Y", {values}}}), planes("other", {{"Y", {std::span(others).subspan(6)}}})}, {{"scene", "a.xml"}});
  const ExrFile file = read_exr(directory / "a.exr");
  EXPECT_EQ(file.channels.size(), 1u);
  EXPECT_EQ(bits(file.channels.at("Y")), bits(values));
  EXPECT_EQ(std::get<std::string>(file.attributes.at("scene")), "a.xml");
  EXPECT_TRUE(file.has_srgb_chromaticities);
}

// Bit 12 of the version field, bytes 4 to 7 (OpenEXR File Layout): readers from before OpenEXR 2 refuse what they do not know.
TEST(image_file_test, only_several_parts_make_a_multi_part_file) {
  const TemporaryDirectory directory;
  const std::vector<float> values = noise(6);
  const auto is_multi_part = [&](const std::vector<ImagePart>& parts) {
    write_exr(directory / "a.exr", window_3_by_2, parts);
    return (content(directory / "a.exr").at(5) & 0x10) != 0;
  };
  EXPECT_FALSE(is_multi_part({planes("grey", {{"Y", {values}}})}));
  EXPECT_TRUE(is_multi_part({planes("grey", {{"Y", {values}}}), planes("other", {{"Y", {values}}})}));
}

TEST(image_file_test, exr_places_a_crop_inside_the_film) {
  const TemporaryDirectory directory;
  const std::vector<float> values = noise(6);
  write_exr(directory / "a.exr", {640, 480, 100, 7, 3, 2}, {planes("", {{"Y", {values}}})});
  const ExrFile file = read_exr(directory / "a.exr");
  EXPECT_EQ(file.window.film_width, 640u);
  EXPECT_EQ(file.window.film_height, 480u);
  EXPECT_EQ(file.window.crop_x, 100u);
  EXPECT_EQ(file.window.crop_y, 7u);
  EXPECT_EQ(file.window.crop_width, 3u);
  EXPECT_EQ(file.window.crop_height, 2u);
  EXPECT_EQ(bits(file.channels.at("Y")), bits(values));
}

TEST(image_file_test, exr_says_its_primaries_and_what_it_was_told) {
  const TemporaryDirectory directory;
  const std::vector<float> values(6);
  write_exr(directory / "a.exr", window_3_by_2, {planes("", {{"Y", {values}}})}, {{"scene", "a.xml"}, {"passes", 7}, {"seconds", 0.1f}});
  const ExrFile file = read_exr(directory / "a.exr");
  EXPECT_TRUE(file.has_srgb_chromaticities);
  EXPECT_EQ(std::get<std::string>(file.attributes.at("scene")), "a.xml");
  EXPECT_EQ(std::get<int>(file.attributes.at("passes")), 7);
  EXPECT_EQ(std::get<float>(file.attributes.at("seconds")), 0.1f);
}

TEST(image_file_test, the_same_pixels_give_the_same_file) {
  const TemporaryDirectory directory;
  for (const Writer write : writers) {
    write(directory / "a");
    write(directory / "b");
    EXPECT_EQ(content(directory / "a"), content(directory / "b"));
  }
}

TEST(image_file_test, a_file_replaces_an_older_one_and_leaves_nothing_beside_it) {
  const TemporaryDirectory directory;
  for (const Writer write : writers) {
    put(directory / "a", "old");
    write(directory / "a");
    EXPECT_NE(content(directory / "a"), "old");
    EXPECT_EQ(directory.names(), Names{"a"});
  }
}

TEST(image_file_test, a_link_stays_a_link_to_the_new_image) {
  const TemporaryDirectory directory;
  put(directory / "real", "old");
  fs::create_symlink("real", directory / "link");
  write_noise_exr(directory / "link");
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_NE(content(directory / "real"), "old");
  EXPECT_EQ(directory.names(), (Names{"link", "real"}));
}

// The limits fall into the first block, among the pixels, and (for OpenEXR, which swallows that failure) nowhere near them.
TEST(image_file_test, a_disk_without_room_keeps_the_old_file_and_no_partial_one) {
  const TemporaryDirectory directory;
  for (const Writer write : writers) {
    write(directory / "a");
    const auto whole = static_cast<rlim_t>(fs::file_size(directory / "a"));
    for (const rlim_t limit : {rlim_t{0}, rlim_t{1}, rlim_t{100}, rlim_t{5000}, whole / 2, whole - 1}) {
      put(directory / "a", "old");
      const test::FileSizeLimit full(limit);
      const std::string message = message_of_failure(write, directory / "a");
      EXPECT_NE(message.find("a: cannot be written: "), std::string::npos) << message;
      EXPECT_NE(message.find("expected room"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(directory.names(), Names{"a"});
      if (limit >= 3) {
        EXPECT_EQ(content(directory / "a"), "old");
      }
    }
  }
}

TEST(image_file_test, a_target_that_cannot_be_a_file_is_refused_and_untouched) {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "folder");
  for (const Writer write : {write_noise_exr, write_noise_png, Writer(require_writable)}) {
    EXPECT_NE(message_of_failure(write, directory / "folder").find("is a directory, expected"), std::string::npos);
    EXPECT_NE(message_of_failure(write, directory / "none/a").find("expected a directory that exists"), std::string::npos);
    EXPECT_NE(message_of_failure(write, "/dev/null").find("is not a regular file, expected"), std::string::npos);
    EXPECT_EQ(directory.names(), Names{"folder"});
  }
}

TEST(image_file_test, a_directory_without_permission_is_refused) {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "locked");
  const test::ReadOnlyDirectory locked(directory / "locked");
  for (const Writer write : {write_noise_exr, write_noise_png, Writer(require_writable)}) {
    EXPECT_NE(message_of_failure(write, directory / "locked/a").find("cannot be created"), std::string::npos);
  }
}

TEST(image_file_test, asking_whether_a_file_can_be_written_changes_nothing) {
  const TemporaryDirectory directory;
  require_writable(directory / "a");
  EXPECT_EQ(directory.names(), Names{});
  put(directory / "a", "old");
  require_writable(directory / "a");
  EXPECT_EQ(directory.names(), Names{"a"});
  EXPECT_EQ(content(directory / "a"), "old");
}

TEST(image_file_test, tone_map_is_the_identity_up_to_its_knee_and_rises_smoothly_to_one) {
  for (const double x : {0.0, 1e-30, 0.18, 0.5, 0.8}) EXPECT_EQ(tone_mapped(x), x);
  for (double x = 0.81; x < 5; x += 0.01) {
    EXPECT_GT(tone_mapped(x), tone_mapped(x - 0.01)) << x;
    EXPECT_NEAR(tone_mapped(x), 0.8 + 0.2 * (1 - std::exp(-(x - 0.8) / 0.2)), 1e-15) << x;
    EXPECT_LE(tone_mapped(x), 1) << x;
  }
  // The slope is continuous: a chord of length h beyond the knee falls short of 1 by h / (2 * 0.2), its second-order term.
  EXPECT_NEAR((tone_mapped(0.8 + 1e-6) - 0.8) / 1e-6, 1 - 2.5e-6, 1e-9);
  EXPECT_EQ(tone_mapped(1e30), 1);
  EXPECT_EQ(tone_mapped(infinity), 1);
  for (const double x : {-1.0, -1e30, -double{infinity}, double{not_a_number}}) EXPECT_EQ(tone_mapped(x), 0);
}

// The inverse curve of IEC 61966-2-1 in its own words. The standard's rounded constants leave the two pieces 3e-8 apart.
TEST(image_file_test, srgb_curve_is_undone_by_the_inverse_of_the_standard) {
  for (int step = 0; step <= 1000; ++step) {
    const double linear = step / 1000.0, encoded = srgb_encoded(linear);
    EXPECT_NEAR(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4), linear, 1e-7);
  }
  EXPECT_EQ(srgb_encoded(0), 0);
  EXPECT_NEAR(srgb_encoded(1), 1, 1e-15);
}

// 0.18 encodes to 0.4613561, 0.5 to 0.7353570, 1 is mapped to 0.9264241 and encodes to 0.9670: times 255, rounded.
TEST(image_file_test, png_holds_the_encoded_bytes_in_order) {
  const TemporaryDirectory directory;
  const std::vector<float> red = {0.0f, 0.18f, 0.5f, 1.0f, infinity, not_a_number};
  const std::vector<float> green_blue = {0.0f, -1.0f, 1e30f, 0.0f, 0.0f, -infinity, 0.0f, 0.001f, 0.5f, 0.0f, 0.0f, 0.18f};
  const std::span<const float> both = green_blue;
  write_png(directory / "a.png", 3, 2, picture({PixelValues{red}, {both, 2}, {both.subspan(1), 2}}));
  EXPECT_EQ(read_png(directory / "a.png"),
            (std::vector<std::uint8_t>{0, 0, 0, 118, 255, 0, 188, 0, 0, 247, 0, 3, 255, 188, 0, 0, 0, 118}));
}

}  // namespace
