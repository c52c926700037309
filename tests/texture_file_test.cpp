// Image files become texels in the file's own format; what is broken or not supported is refused.
#include "../host/texture_file.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfPartType.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "../host/image.h"
#include "encoders.h"
#include "random.h"
#include "temporary_directory.h"

using namespace oclair;
using namespace oclair::test;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::string refusal(const std::string& bytes) {
  try {
    parse_image(bytes);
  } catch (const TextureFileError& error) {
    return error.what();
  }
  return "";
}

template <class T>
std::vector<T> texels(const Image& image) {
  std::vector<T> result(image.texels.size() / sizeof(T));
  std::memcpy(result.data(), image.texels.data(), image.texels.size());
  return result;
}

Bytes counted(std::size_t count, int step = 7) {
  Bytes result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<std::uint8_t>(i * static_cast<std::size_t>(step) + 3);
  return result;
}

std::vector<float> floats(std::size_t count) {
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<float>(i) * 0.25f;
  return result;
}

void put(std::string& bytes, std::size_t at, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> 8 * (count - 1 - i));
}

// CRC of ISO 3309, as PNG's chunks have.
std::uint32_t crc(std::string_view bytes) {
  std::uint32_t c = 0xffffffffu;
  for (const char byte : bytes) {
    c ^= static_cast<unsigned char>(byte);
    for (int i = 0; i < 8; ++i) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
  }
  return ~c;
}

std::string png_that_says(std::uint32_t width, std::uint32_t height) {
  std::string bytes = png_bytes(2, 2, PNG_COLOR_TYPE_RGB, 8, counted(12));
  put(bytes, 16, width, 4);
  put(bytes, 20, height, 4);
  put(bytes, 29, crc(std::string_view(bytes).substr(12, 17)), 4);
  return bytes;
}

const std::string PNG = png_bytes(5, 3, PNG_COLOR_TYPE_RGB, 16, counted(90));
const std::string JPEG = jpeg_bytes(9, 5, JCS_RGB, 3, counted(135));
const std::string EXR =
    exr_bytes(3, 2, {{"R", Imf::HALF, floats(6)}, {"G", Imf::HALF, floats(6)}, {"B", Imf::HALF, floats(6)}});

}  // namespace

TEST(texture_file_test, png_keeps_its_bits_and_drops_alpha) {
  struct Row {
    int type, bits, file_channels, channels;
  };
  for (const bool interlaced : {false, true})
    for (const Row& row : {Row{PNG_COLOR_TYPE_GRAY, 8, 1, 1},
                           {PNG_COLOR_TYPE_GRAY_ALPHA, 8, 2, 1},
                           {PNG_COLOR_TYPE_RGB, 8, 3, 3},
                           {PNG_COLOR_TYPE_RGB_ALPHA, 8, 4, 3},
                           {PNG_COLOR_TYPE_GRAY, 16, 1, 1},
                           {PNG_COLOR_TYPE_GRAY_ALPHA, 16, 2, 1},
                           {PNG_COLOR_TYPE_RGB, 16, 3, 3},
                           {PNG_COLOR_TYPE_RGB_ALPHA, 16, 4, 3}}) {
      const std::size_t bytes = static_cast<std::size_t>(row.bits) / 8,
                        pixel = bytes * static_cast<std::size_t>(row.file_channels);
      const Bytes data = counted(5 * 3 * pixel);
      const Image image = parse_image(png_bytes(5, 3, row.type, row.bits, data, interlaced));
      ASSERT_EQ(image.width, 5u);
      ASSERT_EQ(image.height, 3u);
      ASSERT_EQ(image.channels, static_cast<uint>(row.channels));
      ASSERT_EQ(image.format, row.bits == 16 ? TEXEL_U16 : TEXEL_U8);
      EXPECT_TRUE(image.srgb);
      ASSERT_EQ(image.texels.size(), 15 * bytes * image.channels);
      for (std::size_t p = 0; p < 15; ++p)
        for (std::size_t c = 0; c < image.channels; ++c) {
          const std::size_t from = p * pixel + c * bytes, to = p * image.channels + c;
          const int expected = bytes == 1 ? data[from] : data[from] << 8 | data[from + 1];
          ASSERT_EQ(bytes == 1 ? texels<std::uint8_t>(image)[to] : texels<std::uint16_t>(image)[to], expected)
              << row.type << " " << row.bits;
        }
    }
}

TEST(texture_file_test, png_of_few_bits_and_palettes_become_8_bits) {
  for (const int bits : {1, 2, 4}) {
    Bytes data(15);
    for (std::size_t i = 0; i < 15; ++i) data[i] = static_cast<std::uint8_t>(i % (1u << bits));
    const Image gray = parse_image(png_bytes(5, 3, PNG_COLOR_TYPE_GRAY, bits, data));
    ASSERT_EQ(gray.format, TEXEL_U8);
    ASSERT_EQ(gray.channels, 1u);
    for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(texels<std::uint8_t>(gray)[i], data[i] * 255 / ((1 << bits) - 1));
    const Image palette = parse_image(png_bytes(5, 3, PNG_COLOR_TYPE_PALETTE, bits, data));
    ASSERT_EQ(palette.channels, 3u);
    for (std::size_t i = 0; i < 45; ++i) EXPECT_EQ(texels<std::uint8_t>(palette)[i], data[i / 3] * (i % 3 + 1));
  }
}

// Quality 100 of a flat image: the colour transform rounds to a step or two.
TEST(texture_file_test, jpeg_is_gray_or_rgb) {
  for (const bool progressive : {false, true}) {
    const Image gray = parse_image(jpeg_bytes(20, 11, JCS_GRAYSCALE, 1, Bytes(220, 77), progressive));
    EXPECT_EQ(gray.channels, 1u);
    EXPECT_EQ(gray.format, TEXEL_U8);
    EXPECT_TRUE(gray.srgb);
    ASSERT_EQ(gray.texels.size(), 220u);
    for (const auto t : texels<std::uint8_t>(gray)) ASSERT_NEAR(t, 77, 1);
    Bytes data;
    for (int i = 0; i < 220; ++i) data.insert(data.end(), {200, 100, 50});
    const Image rgb = parse_image(jpeg_bytes(20, 11, JCS_RGB, 3, data, progressive));
    ASSERT_EQ(rgb.channels, 3u);
    EXPECT_EQ(rgb.width, 20u);
    EXPECT_EQ(rgb.height, 11u);
    for (std::size_t i = 0; i < 660; ++i) ASSERT_NEAR(texels<std::uint8_t>(rgb)[i], data[i], 2);
  }
}

// libjpeg may go through the whole image for each of them. The coefficients 1 to n come in two scans each, the others in one.
TEST(texture_file_test, jpeg_has_at_most_100_scans) {
  const auto bytes = [](int n) {
    std::vector<jpeg_scan_info> scans = {{1, {0}, 0, 0, 0, 0}, {1, {0}, n + 1, 63, 0, 0}};
    for (int k = 1; k <= n; ++k) scans.insert(scans.end(), {{1, {0}, k, k, 0, 1}, {1, {0}, k, k, 1, 0}});
    return jpeg_bytes(16, 16, JCS_GRAYSCALE, 1, counted(256), true, scans);
  };
  EXPECT_EQ(refusal(bytes(49)), "");
  EXPECT_EQ(refusal(bytes(50)), "JPEG: it has more than 100 scans");
}

TEST(texture_file_test, exr_stays_half_or_float) {
  const auto r = floats(6), g = std::vector<float>(6, 2.0f), b = std::vector<float>(6, -1.0f);
  for (const auto type : {Imf::HALF, Imf::FLOAT}) {
    const Image image =
        parse_image(exr_bytes(3, 2, {{"R", type, r}, {"G", type, g}, {"B", type, b}, {"A", type, r}, {"Z", Imf::FLOAT, g}}));
    EXPECT_EQ(image.width, 3u);
    EXPECT_EQ(image.height, 2u);
    ASSERT_EQ(image.channels, 3u);
    EXPECT_FALSE(image.srgb);
    ASSERT_EQ(image.format, type == Imf::HALF ? TEXEL_HALF : TEXEL_FLOAT);
    for (std::size_t i = 0; i < 6; ++i) {
      const float expected[] = {r[i], g[i], b[i]};
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(
            type == Imf::HALF ? static_cast<float>(texels<Imath::half>(image)[3 * i + c]) : texels<float>(image)[3 * i + c],
            expected[c]);
    }
  }
  const Image mixed = parse_image(exr_bytes(3, 2, {{"R", Imf::HALF, r}, {"G", Imf::FLOAT, g}, {"B", Imf::UINT, g}}));
  EXPECT_EQ(mixed.format, TEXEL_FLOAT);
  EXPECT_EQ(texels<float>(mixed), (std::vector<float>{0, 2, 2, .25f, 2, 2, .5f, 2, 2, .75f, 2, 2, 1, 2, 2, 1.25f, 2, 2}));
  const Image y = parse_image(exr_bytes(3, 2, {{"Y", Imf::FLOAT, r}}));
  EXPECT_EQ(y.channels, 1u);
  EXPECT_EQ(texels<float>(y), r);
}

// 40 rows: two chunks of the methods that compress 32 together. B44 and DWA lose something of halves: 2^-5 of them is far more.
TEST(texture_file_test, exr_of_every_compression_is_read) {
  std::vector<float> values(7 * 40);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0f + 0.25f * static_cast<float>(i % 7) + static_cast<float>(i / 70);
  for (int method = 0; method < Imf::NUM_COMPRESSION_METHODS; ++method)
    for (const auto type : {Imf::HALF, Imf::FLOAT}) {
      const Image image = parse_image(
          exr_bytes(7, 40, {{"R", type, values}, {"G", type, values}, {"B", type, values}}, static_cast<Imf::Compression>(method)));
      ASSERT_EQ(image.texels.size(), (type == Imf::HALF ? 2 : 4) * 3 * values.size());
      const bool lossy = method >= Imf::B44_COMPRESSION && (type == Imf::HALF || method >= Imf::DWAA_COMPRESSION);
      for (std::size_t i = 0; i < 3 * values.size(); ++i) {
        const float texel = type == Imf::HALF ? static_cast<float>(texels<Imath::half>(image)[i]) : texels<float>(image)[i];
        ASSERT_NEAR(texel, values[i / 3], lossy ? values[i / 3] / 32 : 0) << method << " " << type << " " << i;
      }
    }
}

TEST(texture_file_test, other_formats_and_layouts_are_refused) {
  EXPECT_EQ(refusal(""), "it is not an image of a known format (known: PNG, JPEG, OpenEXR)");
  EXPECT_EQ(refusal("GIF89a"), "it is not an image of a known format (known: PNG, JPEG, OpenEXR)");
  EXPECT_EQ(refusal(jpeg_bytes(8, 8, JCS_CMYK, 4, counted(256))),
            "JPEG: its 4 components are not supported (supported: gray, RGB)");
  const auto v = floats(16);
  EXPECT_EQ(refusal(exr_bytes(4, 4, {{"R", Imf::HALF, v}, {"G", Imf::HALF, v}})),
            "OpenEXR: its channels G, R are not supported (supported: R, G, B, or Y, all at full resolution)");
  EXPECT_NE(refusal(exr_bytes(4, 4, {{"Y", Imf::HALF, v}, {"RY", Imf::HALF, v}, {"BY", Imf::HALF, v}})), "");
  EXPECT_NE(refusal(exr_bytes(4, 4, {{"diffuse.R", Imf::HALF, v}})), "");
  EXPECT_EQ(refusal(exr_bytes(1, 1, {{"Y", Imf::FLOAT, {std::numeric_limits<float>::quiet_NaN()}}})),
            "OpenEXR: a texel is not finite");
  EXPECT_EQ(refusal(exr_bytes(1, 1, {{"Y", Imf::HALF, {1e9f}}})), "OpenEXR: a texel is not finite");
}

// The flag in the version that says so may be missing.
TEST(texture_file_test, deep_pixels_are_refused_whether_or_not_the_version_says_so) {
  Imf::Header header(4, 2);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  ByteSink sink;
  {
    std::vector<unsigned> counts(8, 0);
    std::vector<float*> samples(8, nullptr);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
    buffer.insert("Y", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float*), 4 * sizeof(float*), 4));
    Imf::DeepScanLineOutputFile file(sink, header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  constexpr char DEEP = 0x08;
  ASSERT_EQ(sink.text[5] & DEEP, DEEP);
  for (int i = 0; i < 2; ++i, sink.text[5] = static_cast<char>(sink.text[5] & ~DEEP))
    EXPECT_EQ(refusal(sink.text), "OpenEXR: deep pixels are not supported (supported: flat images)") << i;
}

// What the renderer itself writes among them.
TEST(texture_file_test, exr_of_several_parts_is_its_first) {
  const TemporaryDirectory directory;
  const auto grey = [](const std::string& name, float value) {
    return ImagePart{name, {"Y"}, ValuesOfPixel<float>([value](std::size_t pixel, auto v) { v[0] = value + static_cast<float>(pixel); })};
  };
  write_exr(directory / "a.exr", {3, 2, 0, 0, 3, 2}, {grey("first", 0.5f), grey("second", 100.0f)});
  std::ifstream file(directory / "a.exr", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const Image image = parse_image(bytes);
  EXPECT_EQ(texels<float>(image), (std::vector<float>{0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f}));
  // Of a truncated file it is the whole first part or nothing.
  std::size_t refused = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string beginning = bytes.substr(0, size);
    if (refusal(beginning) != "") ++refused;
    else ASSERT_EQ(texels<float>(parse_image(beginning)), texels<float>(image)) << size;
  }
  EXPECT_GT(refused, bytes.size() / 2);
}

// Headers that promise more than the file holds are refused before memory is taken for it.
TEST(texture_file_test, images_that_are_too_large_are_refused) {
  EXPECT_EQ(refusal(png_that_says(65537, 1)),
            "it has 65537x1 pixels, at most 65536 along each side and 2^28 in all are expected");
  EXPECT_EQ(refusal(png_that_says(65536, 65536)),
            "it has 65536x65536 pixels, at most 65536 along each side and 2^28 in all are expected");
  EXPECT_EQ(refusal(png_that_says(16384, 16384)), "PNG: it breaks off");
  const auto with_last_column = [](std::string exr, const std::string& last) {
    const std::size_t window = exr.find("dataWindow") + std::strlen("dataWindow") + 1 + std::strlen("box2i") + 1 + 4;
    return exr.replace(window + 8, 4, last);
  };
  EXPECT_EQ(refusal(with_last_column(EXR, "\xff\xff\xff\x0f")),
            "it has 268435459x2 pixels, at most 65536 along each side and 2^28 in all are expected");
  // 2^16 columns from -3 on, 256 rows that are compressed together, five channels of 32 bits.
  const std::vector<float> v(256, 1.0f);
  const std::string exr = exr_bytes(
      1, 256, {{"A", Imf::FLOAT, v}, {"B", Imf::FLOAT, v}, {"G", Imf::FLOAT, v}, {"R", Imf::FLOAT, v}, {"Z", Imf::FLOAT, v}},
      Imf::DWAB_COMPRESSION);
  EXPECT_EQ(refusal(with_last_column(exr, std::string("\xfc\xff\0\0", 4))),
            "OpenEXR: a chunk of rows takes 335544320 bytes, more than 268435456");
}

TEST(texture_file_test, every_truncation_is_refused) {
  for (const std::string& whole : {PNG, JPEG, EXR, png_bytes(5, 3, PNG_COLOR_TYPE_PALETTE, 4, Bytes(15, 3), true),
                                   jpeg_bytes(30, 20, JCS_GRAYSCALE, 1, counted(600), true)}) {
    ASSERT_EQ(refusal(whole), "");
    for (std::size_t size = 0; size < whole.size(); ++size)
      ASSERT_NE(refusal(whole.substr(0, size)), "") << size << " of " << whole.size();
  }
}

// A crash or a message without a first line would be the failure; some bytes do not matter.
TEST(texture_file_test, corrupt_bytes_are_refused_or_harmless) {
  Random random(4);
  for (const std::string& whole : {PNG, JPEG, EXR})
    for (std::size_t i = 0; i < whole.size(); ++i)
      for (int n = 0; n < 3; ++n) {
        std::string bytes = whole;
        bytes[i] = static_cast<char>(random.engine());
        EXPECT_EQ(refusal(bytes).find('\n'), std::string::npos) << refusal(bytes);
      }
}
