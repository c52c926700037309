#include <algorithm>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>
#include <jerror.h>

#include "texture_decoders.h"

namespace oclair {
namespace {

constexpr int MAX_SCANS = 100;  // a progressive file has some ten; each can make libjpeg go through all of the image

// No more than 256 pixels come from a byte of a baseline file: a block of 64 has two codes of at least one bit each. A
// progressive file says in one code that many blocks have only their first coefficient, whose codes are left: 512 pixels.
constexpr std::size_t MOST_PIXELS_PER_BYTE = 512;

// libjpeg leaves by longjmp: everything that has a destructor lives here, outside the functions that are jumped over.
struct JpegReader {
  Image image;
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf leave;
  char message[JMSG_LENGTH_MAX] = "";

  JpegReader() = default;
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
};

[[noreturn]] void on_error(j_common_ptr jpeg) {
  auto& reader = *static_cast<JpegReader*>(jpeg->client_data);
  reader.errors.format_message(jpeg, reader.message);
  std::longjmp(reader.leave, 1);
}

// Level -1: the data are corrupt and libjpeg would go on with gray; two such cases are harmless.
void on_message(j_common_ptr jpeg, int level) {
  const int code = jpeg->err->msg_code;
  if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM) on_error(jpeg);
}

void on_progress(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= MAX_SCANS) return;
  auto& reader = *static_cast<JpegReader*>(jpeg->client_data);
  std::snprintf(reader.message, sizeof reader.message, "it has more than %d scans", MAX_SCANS);
  std::longjmp(reader.leave, 1);
}

bool read_header(JpegReader& reader, const unsigned char* bytes, unsigned long size) {
  if (setjmp(reader.leave)) return false;
  jpeg_create_decompress(&reader.jpeg);
  jpeg_mem_src(&reader.jpeg, bytes, size);
  jpeg_read_header(&reader.jpeg, TRUE);
  return true;
}

bool read_rows(JpegReader& reader) {
  if (setjmp(reader.leave)) return false;
  reader.jpeg.progress = &reader.progress;
  reader.progress.progress_monitor = on_progress;
  jpeg_start_decompress(&reader.jpeg);
  while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
    JSAMPROW row = reinterpret_cast<JSAMPROW>(reader.image.texels.data()) +
                   std::size_t{reader.jpeg.output_scanline} * reader.image.width * reader.image.channels;
    jpeg_read_scanlines(&reader.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&reader.jpeg);
  return true;
}

[[noreturn]] void fail(const JpegReader& reader) { throw TextureFileError(std::string("JPEG: ") + reader.message); }

}  // namespace

Image decode_jpeg(std::string_view bytes) {
  JpegReader reader;
  jpeg_decompress_struct& jpeg = reader.jpeg;
  jpeg.err = jpeg_std_error(&reader.errors);
  jpeg.client_data = &reader;
  reader.errors.error_exit = on_error;
  reader.errors.emit_message = on_message;
  if (!read_header(reader, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size())) fail(reader);
  if (jpeg.jpeg_color_space != JCS_GRAYSCALE && jpeg.jpeg_color_space != JCS_YCbCr && jpeg.jpeg_color_space != JCS_RGB)
    throw TextureFileError("JPEG: its " + std::to_string(jpeg.num_components) +
                           " components are not supported (supported: gray, RGB)");
  if (jpeg.arith_code) throw TextureFileError("JPEG: arithmetic coding is not supported (supported: Huffman codes)");
  check_size(jpeg.image_width, jpeg.image_height);
  if (std::size_t{jpeg.image_width} * jpeg.image_height > bytes.size() * MOST_PIXELS_PER_BYTE)
    throw TextureFileError("JPEG: it breaks off");
  const bool gray = jpeg.jpeg_color_space == JCS_GRAYSCALE;
  jpeg.out_color_space = gray ? JCS_GRAYSCALE : JCS_RGB;
  jpeg.dct_method = JDCT_ISLOW;
  reader.image.channels = gray ? 1 : 3;
  reader.image.srgb = true;
  allocate_texels(reader.image, jpeg.image_width, jpeg.image_height);
  if (!read_rows(reader)) fail(reader);
  return std::move(reader.image);
}

}  // namespace oclair
