#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>
#include <ImfXdr.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>

#include "exr_headers.h"
#include "texture_decoders.h"

namespace oclair {
namespace {

class ByteStream : public Imf::IStream {
 public:
  explicit ByteStream(std::string_view bytes) : Imf::IStream("it"), bytes_(bytes) {}

  bool read(char to[], int count) override {
    if (position_ > bytes_.size() || static_cast<std::size_t>(count) > bytes_.size() - position_)
      throw TextureFileError("OpenEXR: it breaks off");
    std::memcpy(to, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

std::vector<std::string> channels_of(const Imf::ChannelList& list) {
  std::vector<std::string> names = {"R", "G", "B"};
  const auto has = [&](const char* name) { return list.findChannel(name) != nullptr; };
  if (has("Y") && !has("R") && !has("G") && !has("B") && !has("RY") && !has("BY")) names = {"Y"};
  std::string present;
  for (auto c = list.begin(); c != list.end(); ++c) present += (present.empty() ? "" : ", ") + std::string(c.name());
  for (const auto& name : names) {
    const auto* channel = list.findChannel(name);
    if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
      throw TextureFileError("OpenEXR: its channels " + present.substr(0, 200) +
                             " are not supported (supported: R, G, B, or Y, all at full resolution)");
  }
  return names;
}

// Before anything is allocated for it. Of several parts the first is the image.
void check_header(std::string_view bytes) {
  ByteStream stream(bytes);
  check_exr_headers(stream, bytes.size());
  int magic = 0, version = 0;
  Imf::Xdr::read<Imf::StreamIO>(stream, magic);
  Imf::Xdr::read<Imf::StreamIO>(stream, version);
  Imf::Header header;
  header.readFrom(stream, version);
  if (Imf::isNonImage(version) || (header.hasType() && !Imf::isImage(header.type())))
    throw TextureFileError("OpenEXR: deep pixels are not supported (supported: flat images)");
  if (!Imf::isMultiPart(version))  // as OpenEXR does, whatever the header says
    header.setType(Imf::isTiled(version) ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  const auto& window = header.dataWindow();
  check_size(static_cast<ulong>(std::max(std::int64_t{window.max.x} - window.min.x + 1, std::int64_t{0})),
             static_cast<ulong>(std::max(std::int64_t{window.max.y} - window.min.y + 1, std::int64_t{0})));
  check_exr_size(header, bytes.size());
}

// Compression that says in a few bytes that a whole chunk is of one value has no bound on what it shrinks.
bool has_bound(Imf::Compression compression) {
  return compression == Imf::NO_COMPRESSION || compression == Imf::RLE_COMPRESSION || compression == Imf::ZIPS_COMPRESSION ||
         compression == Imf::ZIP_COMPRESSION || compression == Imf::PXR24_COMPRESSION || compression == Imf::B44_COMPRESSION ||
         compression == Imf::B44A_COMPRESSION;
}

// Whether so many bytes of a file, by a method with a bound, can become so many of texels. Deflate shrinks by 1032 at most;
// before it PXR24 leaves out one byte of four, and texels may be twice as wide as what is stored.
bool can_hold(std::size_t file, std::size_t texels) {
  constexpr std::size_t GREATEST_RATIO = 1032 * 4 / 3 * 2;
  return texels / GREATEST_RATIO <= file;
}

// The window's pixels, the first at `texels`, rows as far apart as is said.
void read_rows(Imf::InputFile& file, const std::vector<std::string>& names, TexelFormat format, std::byte* texels,
               std::size_t row_stride) {
  const auto& window = file.header().dataWindow();
  const std::size_t size = format == TEXEL_HALF ? 2 : 4, stride = size * names.size();
  // Where the pixel (0, 0) would be, which the window need not have.
  const auto origin = reinterpret_cast<std::intptr_t>(texels) - static_cast<std::intptr_t>(stride) * window.min.x -
                      static_cast<std::intptr_t>(row_stride) * window.min.y;
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < names.size(); ++c)
    frame.insert(names[c], Imf::Slice(format == TEXEL_HALF ? Imf::HALF : Imf::FLOAT,
                                      reinterpret_cast<char*>(origin + static_cast<std::intptr_t>(c * size)), stride, row_stride));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
}

void read_pixels(Imf::InputFile& file, std::size_t file_size, Image& image) {
  const auto& header = file.header();
  const auto names = channels_of(header.channels());
  const auto& window = header.dataWindow();
  image.channels = static_cast<uint>(names.size());
  image.format = TEXEL_HALF;
  for (const auto& name : names)
    if (header.channels()[name].type != Imf::HALF) image.format = TEXEL_FLOAT;
  const std::size_t stride = (image.format == TEXEL_HALF ? 2 : 4) * names.size();
  const auto width = static_cast<ulong>(std::int64_t{window.max.x} - window.min.x + 1),
             height = static_cast<ulong>(std::int64_t{window.max.y} - window.min.y + 1);
  check_size(width, height);
  if (has_bound(header.compression())) {
    if (!can_hold(file_size, width * height * stride)) throw TextureFileError("OpenEXR: it breaks off");
  } else {
    // Every row into the same one: a file that does not hold what it claims is refused before there is memory for it.
    std::vector<std::byte> row(width * stride);
    read_rows(file, names, image.format, row.data(), 0);
  }
  allocate_texels(image, width, height);
  read_rows(file, names, image.format, image.texels.data(), stride * width);
}

bool is_finite(const Image& image) {
  const auto all = [&](auto finite, auto value) {
    for (std::size_t i = 0; i < image.texels.size(); i += sizeof(value)) {
      std::memcpy(&value, image.texels.data() + i, sizeof(value));
      if (!finite(value)) return false;
    }
    return true;
  };
  if (image.format == TEXEL_FLOAT) return all([](float value) { return std::isfinite(value); }, float{});
  return all([](std::uint16_t half) { return (half & 0x7c00u) != 0x7c00u; }, std::uint16_t{});
}

}  // namespace

Image decode_exr(std::string_view bytes) {
  Image image;
  try {
    check_header(bytes);
    ByteStream stream(bytes);
    Imf::InputFile file(stream, 0);
    if (!file.isComplete()) throw TextureFileError("OpenEXR: it breaks off");
    read_pixels(file, bytes.size(), image);
  } catch (const TextureFileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw TextureFileError(std::string("OpenEXR: ") + error.what());
  }
  if (!is_finite(image)) throw TextureFileError("OpenEXR: a texel is not finite");
  return image;
}

}  // namespace oclair
