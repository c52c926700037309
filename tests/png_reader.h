// Reads back what write_png has written.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <filesystem>
#include <vector>

// Red, green and blue of all pixels, row by row.
inline std::vector<std::uint8_t> read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, path.c_str()));
  EXPECT_EQ(image.format, png_uint_32{PNG_FORMAT_RGB});
  EXPECT_EQ(image.flags & PNG_IMAGE_FLAG_COLORSPACE_NOT_sRGB, 0u);
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
  return bytes;
}
