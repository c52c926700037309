#include "exr_headers.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <ImfXdr.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

namespace oclair {
namespace {

constexpr std::uint64_t MAX_CHUNK = std::uint64_t{1} << 28;  // bytes of a row of tiles, or of rows compressed together

// Bytes of the values of OpenEXR's types, of those that have always as many.
const std::map<std::string, int> FIXED_SIZES = {
    {"box2f", 16}, {"box2i", 16},   {"chromaticities", 32}, {"compression", 1}, {"deepImageState", 1}, {"double", 8},
    {"envmap", 1}, {"float", 4},    {"int", 4},             {"keycode", 28},    {"lineOrder", 1},      {"m33d", 72},
    {"m33f", 36},  {"m44d", 128},   {"m44f", 64},           {"rational", 8},    {"tiledesc", 9},       {"timecode", 8},
    {"v2d", 16},   {"v2f", 8},      {"v2i", 8},             {"v3d", 24},        {"v3f", 12},           {"v3i", 12}};
constexpr std::uint64_t CHANNEL_SIZE = 16;  // of what a list of channels says of each, after its name

class HeaderWalk {
 public:
  HeaderWalk(Imf::IStream& stream, std::uint64_t size) : stream_(stream), size_(size) {}

  int integer() {
    require(4);
    int value = 0;
    Imf::Xdr::read<Imf::StreamIO>(stream_, value);
    return value;
  }

  // Names of attributes and of their types; both have at most 255 bytes.
  std::string name() {
    std::string name;
    for (char byte;; name += byte) {
      require(1);
      stream_.read(&byte, 1);
      if (byte == 0) return name;
      if (name.size() == 255) throw std::runtime_error("a name in its header is too long");
    }
  }

  void require(std::uint64_t bytes) {
    if (bytes > size_ - stream_.tellg()) throw std::runtime_error("it breaks off in its header");
  }

  // True if there was one, false at the end of the header.
  bool attribute() {
    if (name().empty()) return false;
    const std::string type = name();
    const int bytes = integer();
    if (bytes < 0) throw std::runtime_error("an attribute has a negative size");
    require(static_cast<std::uint64_t>(bytes));
    const std::uint64_t end = stream_.tellg() + static_cast<std::uint64_t>(bytes);
    check_value(type, bytes, end);
    stream_.seekg(end);
    return true;
  }

 private:
  // OpenEXR does not skip what a value leaves of its size, nor notice that it needs more: it would take what follows for the
  // next attribute, with a size that has not been seen here.
  void check_value(const std::string& type, int bytes, std::uint64_t end) {
    const auto fixed = FIXED_SIZES.find(type);
    bool fits = fixed == FIXED_SIZES.end() || bytes == fixed->second;
    if (type == "stringvector") strings(end);
    if (type == "floatvector") fits = bytes % 4 == 0;
    // OpenEXR 3.1 reads more of it than it has; only images of object numbers hold one.
    if (type == "idmanifest") throw std::runtime_error("its header has an idmanifest, which cannot be read safely");
    if (type == "preview") {
      const std::int64_t width = integer(), height = integer();
      fits = width >= 0 && height >= 0 && width * height == (std::int64_t{bytes} - 8) / 4 && bytes % 4 == 0;
    }
    if (type == "chlist") {
      while (!name().empty()) skip(CHANNEL_SIZE);
      fits = stream_.tellg() == end;
    }
    if (!fits) throw std::runtime_error("an attribute in its header has not the size of its type");
  }

  void skip(std::uint64_t bytes) {
    require(bytes);
    stream_.seekg(stream_.tellg() + bytes);
  }

  void strings(std::uint64_t end) {
    while (stream_.tellg() < end) {
      const int bytes = integer();
      const std::uint64_t at = stream_.tellg();
      if (bytes < 0 || at > end || static_cast<std::uint64_t>(bytes) > end - at)
        throw std::runtime_error("a string in its header is too long");
      stream_.seekg(at + static_cast<std::uint64_t>(bytes));
    }
  }

  Imf::IStream& stream_;
  std::uint64_t size_;
};

void require_at_most(const char* what, std::uint64_t bytes, std::uint64_t most) {
  if (bytes > most)
    throw std::runtime_error(std::string(what) + " takes " + std::to_string(bytes) + " bytes, more than " +
                             std::to_string(most));
}

// At most as many rows are compressed together.
std::uint64_t rows_of_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION: return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION: return 16;
    case Imf::DWAB_COMPRESSION: return 256;
    default: return 32;
  }
}

std::uint64_t extent(int min, int max) { return static_cast<std::uint64_t>(std::int64_t{max} - min + 1); }

}  // namespace

void check_exr_headers(Imf::IStream& stream, std::uint64_t size) {
  stream.seekg(0);
  HeaderWalk walk(stream, size);
  if (walk.integer() != Imf::MAGIC) throw std::runtime_error("it does not begin as an OpenEXR file does");
  const bool several = Imf::isMultiPart(walk.integer());
  do {
    if (!walk.attribute()) break;  // the headers of several parts end with an empty one
    while (walk.attribute()) {
    }
  } while (several);
  stream.seekg(0);
}

// Nothing overflows: extents, sizes of tiles and numbers of channels are below 2^32, a row that has passed has less than 2^23
// pixels.
void check_exr_size(const Imf::Header& header, std::uint64_t size) {
  const Imath::Box2i window = header.dataWindow();
  const std::uint64_t width = extent(window.min.x, window.max.x), height = extent(window.min.y, window.max.y);
  std::uint64_t channels = 0, stored = 0;  // bytes of a pixel
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    ++channels;
    stored += channel.channel().type == Imf::HALF ? 2 : 4;
  }
  const std::uint64_t pixel = 4 * std::max<std::uint64_t>(channels, 1);
  require_at_most("a row of pixels", width > MAX_EXR_ROW ? width : width * pixel, MAX_EXR_ROW);
  if (header.type() == Imf::SCANLINEIMAGE)  // whose header may have tiles as well, which OpenEXR does not look at
    require_at_most("a chunk of rows", std::min(rows_of_chunk(header.compression()), height) * width * stored, MAX_CHUNK);
  if (header.type() != Imf::TILEDIMAGE || !header.hasTileDescription()) return;
  const Imf::TileDescription tiles = header.tileDescription();
  const std::uint64_t columns = std::max<std::uint64_t>(width, tiles.xSize);
  require_at_most("a row of tiles",
                  std::max<std::uint64_t>(columns, tiles.ySize) > MAX_CHUNK ? std::uint64_t{1} << 32 : columns * tiles.ySize,
                  MAX_CHUNK / pixel);
  if (tiles.xSize == 0 || tiles.ySize == 0) throw std::runtime_error("its tiles have no pixels");
  const std::uint64_t count = ((width - 1) / tiles.xSize + 1) * ((height - 1) / tiles.ySize + 1);
  if (count > size / 8) throw std::runtime_error("it breaks off");
}

}  // namespace oclair
