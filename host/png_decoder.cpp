#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "texture_decoders.h"

namespace oclair {
namespace {

// libpng leaves by longjmp: everything that has a destructor lives here, outside the functions that are jumped over.
struct PngReader {
  std::string_view rest;
  Image image;
  std::vector<png_bytep> rows;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngReader() = default;
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest;
  if (count > rest.size()) png_error(png, "it breaks off");
  std::memcpy(to, rest.data(), count);
  rest.remove_prefix(count);
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<PngReader*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

bool read_header(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_set_read_fn(reader.png, &reader, read_bytes);
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_size says it more clearly
  png_set_chunk_malloc_max(reader.png, 1u << 26);
  png_read_info(reader.png, reader.info);
  return true;
}

bool set_layout(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  const int type = png_get_color_type(reader.png, reader.info);
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(reader.png);
  if (type == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(reader.png);
  png_set_strip_alpha(reader.png);
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);  // of 16 bits only
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_image(reader.png, reader.rows.data());
  png_read_end(reader.png, nullptr);
  return true;
}

[[noreturn]] void fail(const PngReader& reader) { throw TextureFileError("PNG: " + reader.message); }

}  // namespace

Image decode_png(std::string_view bytes) {
  PngReader reader;
  reader.rest = bytes;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();
  if (!read_header(reader)) fail(reader);
  check_size(png_get_image_width(reader.png, reader.info), png_get_image_height(reader.png, reader.info));
  if (!set_layout(reader)) fail(reader);
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const ulong height = png_get_image_height(reader.png, reader.info);
  // Deflate shrinks by 1032 at most: no header can ask for memory that the file cannot fill.
  if (row_bytes > bytes.size() * 1100 / height) throw TextureFileError("PNG: it breaks off");
  Image& image = reader.image;
  image.channels = png_get_channels(reader.png, reader.info);
  image.format = png_get_bit_depth(reader.png, reader.info) == 16 ? TEXEL_U16 : TEXEL_U8;
  image.srgb = true;
  allocate_texels(image, png_get_image_width(reader.png, reader.info), height);
  reader.rows.resize(height);
  for (std::size_t y = 0; y < height; ++y) reader.rows[y] = reinterpret_cast<png_bytep>(image.texels.data() + y * row_bytes);
  if (!read_rows(reader)) fail(reader);
  return std::move(image);
}

}  // namespace oclair
