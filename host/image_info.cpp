#include "image_info.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "error.h"
#include "exr_headers.h"
#include "exr_stream.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t ROWS_AT_ONCE = 256;

template <class... Values>
std::string numbers(const Values&... values) {
  std::ostringstream text;
  text.precision(9);  // every float32 is told from its neighbours
  const char* separator = "";
  ((text << separator << values, separator = " "), ...);
  return text.str();
}

std::string text_of(const Imf::Attribute& attribute) {
  if (const auto* a = dynamic_cast<const Imf::StringAttribute*>(&attribute)) return one_line(a->value());
  if (const auto* a = dynamic_cast<const Imf::IntAttribute*>(&attribute)) return numbers(a->value());
  if (const auto* a = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) return numbers(a->value());
  if (const auto* a = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) return numbers(a->value());
  if (const auto* a = dynamic_cast<const Imf::V2iAttribute*>(&attribute)) return numbers(a->value().x, a->value().y);
  if (const auto* a = dynamic_cast<const Imf::V2fAttribute*>(&attribute)) return numbers(a->value().x, a->value().y);
  if (const auto* a = dynamic_cast<const Imf::V3fAttribute*>(&attribute))
    return numbers(a->value().x, a->value().y, a->value().z);
  if (const auto* a = dynamic_cast<const Imf::RationalAttribute*>(&attribute))
    return std::to_string(a->value().n) + "/" + std::to_string(a->value().d);
  if (const auto* a = dynamic_cast<const Imf::ChromaticitiesAttribute*>(&attribute)) {
    const Imf::Chromaticities& c = a->value();
    return numbers("red", c.red.x, c.red.y, "green", c.green.x, c.green.y, "blue", c.blue.x, c.blue.y, "white", c.white.x,
                   c.white.y);
  }
  return one_line("(" + std::string(attribute.typeName()) + ")");
}

bool is_structural(const std::string& name) {
  constexpr std::array names = {
      "channels",           "compression",       "dataWindow", "displayWindow", "lineOrder", "pixelAspectRatio",
      "screenWindowCenter", "screenWindowWidth", "tiles",      "name",          "type",      "version",
      "chunkCount"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::uint64_t extent(int min, int max) { return static_cast<std::uint64_t>(std::int64_t{max} - min + 1); }

PartInfo describe(const Imf::Header& header) {
  PartInfo part;
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  if (header.hasName()) part.name = one_line(header.name());
  part.type = header.hasType()              ? one_line(header.type())
              : header.hasTileDescription() ? Imf::TILEDIMAGE
                                            : Imf::SCANLINEIMAGE;
  part.width = extent(data.min.x, data.max.x);
  part.height = extent(data.min.y, data.max.y);
  part.x = std::int64_t{data.min.x} - display.min.x;
  part.y = std::int64_t{data.min.y} - display.min.y;
  part.film_width = extent(display.min.x, display.max.x);
  part.film_height = extent(display.min.y, display.max.y);
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const Imf::PixelType type = channel.channel().type;
    part.channels.emplace_back().name = one_line(channel.name());
    part.channels.back().type = type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
  }
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (!is_structural(attribute.name()))
      part.attributes.emplace_back(one_line(attribute.name()), text_of(attribute.attribute()));
  return part;
}

// Floor of a / b.
std::int64_t floor_divided(std::int64_t a, std::int64_t b) { return a / b - (a % b != 0 && (a < 0) != (b < 0)); }

// Some rows of one channel, which may have fewer samples than there are pixels: those at multiples of its sampling.
struct ChannelRows {
  Imf::Channel channel;
  std::vector<std::uint32_t> values;  // floats as their bits
  std::uint64_t columns = 0;

  Imf::Slice slice(const Imath::Box2i& window, std::int64_t top, std::uint64_t rows) {
    const std::int64_t left = floor_divided(window.min.x, channel.xSampling);
    columns = static_cast<std::uint64_t>(floor_divided(window.max.x, channel.xSampling) - left + 1);
    values.assign(columns * rows, 0);
    const std::int64_t first_row = floor_divided(top, channel.ySampling);
    const auto stride = static_cast<std::int64_t>(4 * columns);
    char* const base =
        reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(values.data()) - 4 * left - stride * first_row);
    return {channel.type == Imf::UINT ? Imf::UINT : Imf::FLOAT, base, 4, 4 * columns, channel.xSampling, channel.ySampling};
  }

  // Whether a row of pixels has samples of this channel.
  bool has_row(std::int64_t y) const { return y % channel.ySampling == 0; }
};

void add_values(ChannelInfo& info, double& sum, const ChannelRows& rows, std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t i = first; i < end; ++i) {
    const double value = rows.channel.type == Imf::UINT ? rows.values[i] : double{std::bit_cast<float>(rows.values[i])};
    if (std::isnan(value))
      ++info.nan;
    else if (std::isinf(value))
      ++info.infinite;
    else {
      ++info.finite;
      sum += value;
      info.min = std::min(info.min, value);
      info.max = std::max(info.max, value);
    }
  }
}

void read_values(Imf::InputPart& input, PartInfo& part) {
  const Imf::Header& header = input.header();
  const Imath::Box2i window = header.dataWindow();
  std::vector<ChannelRows> all;
  std::vector<std::string> names;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    all.push_back({channel.channel(), {}, 0});
    names.push_back(channel.name());
  }
  std::vector<double> sums(all.size());
  const std::uint64_t row_bytes = 4 * part.width * std::max<std::uint64_t>(all.size(), 1);
  const std::uint64_t at_once = std::clamp<std::uint64_t>(MAX_EXR_ROW / row_bytes, 1, ROWS_AT_ONCE);
  for (std::uint64_t done = 0; done < part.height; done += at_once) {
    const std::uint64_t rows = std::min(at_once, part.height - done);
    const std::int64_t top = window.min.y + static_cast<std::int64_t>(done), end = top + static_cast<std::int64_t>(rows);
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < all.size(); ++c) buffer.insert(names[c], all[c].slice(window, top, rows));
    input.setFrameBuffer(buffer);
    input.readPixels(static_cast<int>(top), static_cast<int>(end - 1));
    for (std::size_t c = 0; c < all.size(); ++c) {
      const std::int64_t first_row = floor_divided(top, all[c].channel.ySampling);
      for (std::int64_t y = top; y < end; ++y) {
        if (!all[c].has_row(y)) continue;
        const auto row = static_cast<std::uint64_t>(floor_divided(y, all[c].channel.ySampling) - first_row);
        add_values(part.channels[c], sums[c], all[c], row * all[c].columns, (row + 1) * all[c].columns);
      }
    }
  }
  for (std::size_t c = 0; c < all.size(); ++c)
    if (part.channels[c].finite > 0) part.channels[c].mean = sums[c] / static_cast<double>(part.channels[c].finite);
}

std::vector<PartInfo> read_parts(const fs::path& path, std::FILE* opened) {
  FileStream stream(opened);
  const std::uint64_t size = fs::file_size(path);
  check_exr_headers(stream, size);
  Imf::MultiPartInputFile file(stream, 0, false);
  std::vector<PartInfo> parts;
  for (int i = 0; i < file.parts(); ++i) {
    PartInfo& part = parts.emplace_back(describe(file.header(i)));
    if (part.type == Imf::DEEPSCANLINE || part.type == Imf::DEEPTILE) continue;
    if (!file.partComplete(i)) throw std::runtime_error("it breaks off");
    check_exr_size(file.header(i), size);
    Imf::InputPart input(file, i);
    read_values(input, part);
  }
  return parts;
}

}  // namespace

bool is_exr(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const InputFile file = open_input(path);
  std::array<char, 4> first{};
  return file && std::fread(first.data(), 1, first.size(), file.get()) == first.size() &&
         first == std::array{'\x76', '\x2f', '\x31', '\x01'};
}

std::vector<PartInfo> read_image_info(const fs::path& path) {
  const auto refuse = [&](const std::string& what) -> Error {
    return {Exit::scene, path.string() + ": " + one_line(what) + ", expected an OpenEXR file that is whole"};
  };
  const InputFile file = open_input(path);
  if (!file) throw refuse("it cannot be read");
  try {
    return read_parts(path, file.get());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw refuse(error.what());
  }
}

}  // namespace oclair
