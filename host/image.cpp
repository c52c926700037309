#include "image.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "error.h"
#include "parallel.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& expected) {
  throw Error(Exit::render_failed, path.string() + ": " + what + ", expected " + expected);
}

// OpenEXR's output to a C stream. It remembers a failure, because OpenEXR writes the last of a file in a destructor
// and swallows what is thrown there.
class ExrStream : public Imf::OStream {
 public:
  ExrStream(std::FILE* file, const std::string& name) : Imf::OStream(name.c_str()), file_(file) {}

  void write(const char bytes[], int count) override {
    check(std::fwrite(bytes, 1, static_cast<std::size_t>(count), file_) == static_cast<std::size_t>(count));
  }
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(ftello(file_)); }
  void seekp(std::uint64_t position) override { check(fseeko(file_, static_cast<off_t>(position), SEEK_SET) == 0); }

  int error() const { return error_; }

 private:
  void check(bool succeeded) {
    if (succeeded) return;
    if (error_ == 0) error_ = errno;
    throw std::system_error(error_, std::generic_category());
  }

  std::FILE* file_;
  int error_ = 0;
};

Imf::Header exr_header(const ImageWindow& window, const ImagePart& part) {
  const auto at = [](unsigned x, unsigned y) { return Imath::V2i(static_cast<int>(x), static_cast<int>(y)); };
  const Imath::Box2i display(at(0, 0), at(window.film_width - 1, window.film_height - 1));
  const Imath::Box2i data(at(window.crop_x, window.crop_y),
                          at(window.crop_x + window.crop_width - 1, window.crop_y + window.crop_height - 1));
  Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709, which is sRGB; alike in all parts
  const bool integers = std::holds_alternative<ValuesOfPixel<std::uint32_t>>(part.values);
  for (const std::string& name : part.channels) header.channels().insert(name, Imf::Channel(integers ? Imf::UINT : Imf::FLOAT));
  return header;
}

std::vector<Imf::Header> exr_headers(const ImageWindow& window, const std::vector<ImagePart>& parts,
                                     const ImageAttributes& attributes) {
  std::vector<Imf::Header> headers;
  for (const ImagePart& part : parts) {
    Imf::Header& header = headers.emplace_back(exr_header(window, part));
    header.setType(Imf::SCANLINEIMAGE);
    if (parts.size() > 1) header.setName(part.name);
  }
  for (const auto& [name, value] : attributes) {
    Imf::Header& header = headers.front();
    if (const auto* text = std::get_if<std::string>(&value)) header.insert(name, Imf::StringAttribute(*text));
    if (const auto* number = std::get_if<int>(&value)) header.insert(name, Imf::IntAttribute(*number));
    if (const auto* number = std::get_if<float>(&value)) header.insert(name, Imf::FloatAttribute(*number));
  }
  return headers;
}

template <class Value>
void write_pixels(Imf::OutputPart& out, const ImagePart& part, const ValuesOfPixel<Value>& values) {
  static_assert(sizeof(Value) == 4);
  constexpr int rows_at_once = 64;  // whole blocks of ZIP, which have 16
  const Imath::Box2i window = out.header().dataWindow();
  const std::size_t count = part.channels.size(), width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  std::vector<Value> buffer(count * width * rows_at_once);
  for (int top = window.min.y; top <= window.max.y; top += rows_at_once) {
    const std::size_t rows = static_cast<std::size_t>(std::min(rows_at_once, window.max.y - top + 1));
    const std::size_t first = static_cast<std::size_t>(top - window.min.y) * width;
    parallel_pieces(rows * width, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values(first + i, {buffer.data() + i * count, count});
    });
    Imf::FrameBuffer pixels;
    const std::size_t step = count * sizeof(Value);
    for (std::size_t c = 0; c < count; ++c)
      pixels.insert(part.channels[c], Imf::Slice::Make(std::is_same_v<Value, float> ? Imf::FLOAT : Imf::UINT, buffer.data() + c,
                                                  Imath::V2i(window.min.x, top), static_cast<std::int64_t>(width),
                                                  static_cast<std::int64_t>(rows), step, step * width));
    out.setFrameBuffer(pixels);
    out.writePixels(static_cast<int>(rows));
    if (part.written) part.written(first, first + rows * width);
  }
}

std::uint8_t srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::floor(255.0 * srgb_encoded(tone_mapped(linear)) + 0.5));
}

// libpng leaves by longjmp: everything that has a destructor lives here, outside the function that is jumped over.
struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string message;
  std::vector<float> rgb;
  std::vector<png_byte> bytes;

  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp message) {
  static_cast<PngWriter*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void on_png_warning(png_structp, png_const_charp) {}

bool begin_png(PngWriter& writer, std::FILE* file, unsigned width, unsigned height) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_init_io(writer.png, file);
  png_set_IHDR(writer.png, writer.info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(writer.png, writer.info);
  return true;
}

bool write_png_rows(PngWriter& writer, std::size_t row_bytes) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  for (std::size_t row = 0; row < writer.bytes.size(); row += row_bytes) png_write_row(writer.png, writer.bytes.data() + row);
  return true;
}

bool end_png(PngWriter& writer) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_write_end(writer.png, writer.info);
  return true;
}

// Asks for the rows of the picture and writes them. Returns libpng's message if it fails, else nothing.
std::string write_png_to(std::FILE* file, unsigned width, unsigned height, const RgbOfPixels& rgb) {
  constexpr unsigned rows_at_once = 16;
  PngWriter writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_png_error, on_png_warning);
  if (writer.png) writer.info = png_create_info_struct(writer.png);
  if (!writer.info) throw std::bad_alloc();
  const std::size_t row = std::size_t{3} * width;
  bool good = begin_png(writer, file, width, height);
  for (unsigned y = 0; good && y < height; y += rows_at_once) {
    writer.rgb.resize(row * std::min(rows_at_once, height - y));
    rgb(std::size_t{y} * width, writer.rgb);
    writer.bytes.resize(writer.rgb.size());
    std::transform(writer.rgb.begin(), writer.rgb.end(), writer.bytes.begin(), srgb_byte);
    good = write_png_rows(writer, row);
  }
  return good && end_png(writer) ? "" : writer.message.empty() ? "unknown error" : writer.message;
}

// A C stream into memory.
class MemoryStream {
 public:
  MemoryStream() : file_(open_memstream(&bytes_, &size_)) {
    if (!file_) throw std::bad_alloc();
  }
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;
  ~MemoryStream() {
    std::fclose(file_);
    std::free(bytes_);
  }

  std::FILE* file() const { return file_; }

  std::string take() {
    if (std::fflush(file_) != 0) throw std::bad_alloc();
    return {bytes_, size_};
  }

 private:
  char* bytes_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* file_;
};

}  // namespace

void write_exr(const fs::path& path, const ImageWindow& window, const std::vector<ImagePart>& parts,
               const ImageAttributes& attributes) {
  assert(!parts.empty());
  FileAside aside(path);
  ExrStream stream(aside.file(), path.string());
  try {
    const std::vector<Imf::Header> headers = exr_headers(window, parts, attributes);
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      Imf::OutputPart out(file, static_cast<int>(i));
      std::visit([&](const auto& values) { write_pixels(out, parts[i], values); }, parts[i].values);
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (stream.error() == 0) fail(path, std::string("cannot be written: ") + error.what(), "an image that OpenEXR accepts");
  }
  if (stream.error() != 0) aside.fail_to_write(stream.error());
  aside.commit();
}

void write_png(const fs::path& path, unsigned width, unsigned height, const RgbOfPixels& rgb) {
  FileAside aside(path);
  if (const std::string error = write_png_to(aside.file(), width, height, rgb); !error.empty())
    fail(path, "cannot be written: " + error, "room for the whole image and a size that PNG allows");
  aside.commit();
}

std::string encoded_png(unsigned width, unsigned height, const RgbOfPixels& rgb) {
  MemoryStream stream;
  if (const std::string error = write_png_to(stream.file(), width, height, rgb); !error.empty())
    throw Error(Exit::render_failed, "a PNG cannot be made: " + error + ", expected a size that PNG allows");
  return stream.take();
}

double tone_mapped(double linear) {
  constexpr double knee = 0.8;
  if (!(linear > 0)) return 0;  // NaN too
  if (linear <= knee) return linear;
  return knee + (1 - knee) * -std::expm1(-(linear - knee) / (1 - knee));
}

double srgb_encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace oclair
