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
#include <cstdio>
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
void write_pixels(Imf::OutputPart& out, const std::vector<std::string>& channels, const ValuesOfPixel<Value>& values) {
  static_assert(sizeof(Value) == 4);
  constexpr int rows_at_once = 64;  // whole blocks of ZIP, which have 16
  const Imath::Box2i window = out.header().dataWindow();
  const std::size_t count = channels.size(), width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
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
      pixels.insert(channels[c], Imf::Slice::Make(std::is_same_v<Value, float> ? Imf::FLOAT : Imf::UINT, buffer.data() + c,
                                                  Imath::V2i(window.min.x, top), static_cast<std::int64_t>(width),
                                                  static_cast<std::int64_t>(rows), step, step * width));
    out.setFrameBuffer(pixels);
    out.writePixels(static_cast<int>(rows));
  }
}

[[maybe_unused]] bool covers(const PixelValues& channel, std::size_t pixels) {
  return pixels > 0 && channel.stride > 0 && (channel.values.size() - 1) / channel.stride >= pixels - 1;
}

std::uint8_t srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::floor(255.0 * srgb_encoded(tone_mapped(linear)) + 0.5));
}

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
      std::visit([&](const auto& values) { write_pixels(out, parts[i].channels, values); }, parts[i].values);
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (stream.error() == 0) fail(path, std::string("cannot be written: ") + error.what(), "an image that OpenEXR accepts");
  }
  if (stream.error() != 0) aside.fail_to_write(stream.error());
  aside.commit();
}

void write_png(const fs::path& path, unsigned width, unsigned height, const std::array<PixelValues, 3>& rgb) {
  const std::size_t pixels = std::size_t{width} * height;
  std::vector<std::uint8_t> bytes(3 * pixels);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    assert(covers(rgb[channel], pixels));
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      bytes[3 * pixel + channel] = srgb_byte(rgb[channel].values[pixel * rgb[channel].stride]);
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGB;
  FileAside aside(path);
  if (!png_image_write_to_stdio(&image, aside.file(), 0, bytes.data(), 0, nullptr)) {
    fail(path, std::string("cannot be written: ") + image.message, "room for the whole image and a size that PNG allows");
  }
  aside.commit();
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
