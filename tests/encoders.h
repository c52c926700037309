// Image files made in memory.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <jpeglib.h>
#include <png.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace oclair::test {

// Bits up to 8: one byte for each component; 16: two, the high one first. Palette entry i is (i, 2i, 3i).
inline std::string png_bytes(unsigned width, unsigned height, int color_type, int bits, std::vector<std::uint8_t> data,
                             bool interlaced = false) {
  std::string result;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &result,
      [](png_structp p, png_bytep bytes, std::size_t count) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(bytes), count);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, bits, color_type, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (color_type == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette;
    for (int i = 0; i < 1 << bits; ++i)
      palette.push_back({static_cast<png_byte>(i), static_cast<png_byte>(2 * i), static_cast<png_byte>(3 * i)});
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    std::vector<png_byte> alpha(palette.size(), 128);
    png_set_tRNS(png, info, alpha.data(), static_cast<int>(alpha.size()), nullptr);
  }
  png_write_info(png, info);
  if (bits < 8) png_set_packing(png);
  const int passes = png_set_interlace_handling(png);
  const std::size_t row = data.size() / height;
  for (int pass = 0; pass < passes; ++pass)
    for (unsigned y = 0; y < height; ++y) png_write_row(png, data.data() + y * row);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return result;
}

// Progressive in the usual scans, or in those that are given.
inline std::string jpeg_bytes(unsigned width, unsigned height, J_COLOR_SPACE space, int components,
                              std::vector<std::uint8_t> data, bool progressive = false,
                              const std::vector<jpeg_scan_info>& scans = {}) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = components;
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  if (!scans.empty()) {
    jpeg.scan_info = scans.data();
    jpeg.num_scans = static_cast<int>(scans.size());
  }
  jpeg_start_compress(&jpeg, TRUE);
  for (unsigned y = 0; y < height; ++y) {
    JSAMPROW row = data.data() + y * width * static_cast<unsigned>(components);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string result(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return result;
}

struct ExrChannel {
  std::string name;
  Imf::PixelType type;
  std::vector<float> values;
  int sampling = 1;
};

class ByteSink : public Imf::OStream {
 public:
  ByteSink() : Imf::OStream("memory") {}
  void write(const char bytes[], int count) override {
    if (text.size() < position_ + static_cast<std::size_t>(count)) text.resize(position_ + static_cast<std::size_t>(count));
    text.replace(position_, static_cast<std::size_t>(count), bytes, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  std::string text;

 private:
  std::size_t position_ = 0;
};

// The data window begins at (-3, 5).
inline std::string exr_bytes(int width, int height, const std::vector<ExrChannel>& channels,
                             Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  const Imath::Box2i window({-3, 5}, {-3 + width - 1, 5 + height - 1});
  Imf::Header header(window, window);
  header.compression() = compression;
  Imf::FrameBuffer frame;
  for (const auto& c : channels) {
    header.channels().insert(c.name, Imf::Channel(c.type, c.sampling, c.sampling));
  }
  std::vector<std::vector<Imath::half>> halves(channels.size());
  std::vector<std::vector<std::uint32_t>> integers(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto& c = channels[i];
    for (const float v : c.values)
      halves[i].emplace_back(v), integers[i].push_back(c.type == Imf::UINT ? static_cast<std::uint32_t>(v) : 0);
    const void* data = c.type == Imf::HALF   ? static_cast<const void*>(halves[i].data())
                       : c.type == Imf::UINT ? static_cast<const void*>(integers[i].data())
                                             : static_cast<const void*>(c.values.data());
    const std::size_t size = c.type == Imf::HALF ? 2 : 4;
    frame.insert(c.name, Imf::Slice::Make(c.type, data, window, size,
                                          size * static_cast<std::size_t>((width + c.sampling - 1) / c.sampling), c.sampling,
                                          c.sampling));
  }
  ByteSink sink;
  {
    Imf::OutputFile file(sink, header, 0);
    file.setFrameBuffer(frame);
    file.writePixels(height);
  }
  return sink.text;
}

}  // namespace oclair::test
