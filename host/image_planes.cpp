#include "image_planes.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "error.h"
#include "exr_headers.h"
#include "exr_stream.h"

namespace oclair {
namespace {

constexpr std::uint64_t ROWS_AT_ONCE = 64;

using Names = std::vector<std::string>;

std::string joined_names(const Imf::ChannelList& list) {
  std::string names;
  for (auto channel = list.begin(); channel != list.end(); ++channel)
    names += (names.empty() ? "" : ", ") + std::string(channel.name());
  return names.substr(0, 200);
}

bool has_all(const Imf::Header& header, const Names& names) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    return channel && channel->xSampling == 1 && channel->ySampling == 1;
  });
}

Names colour_channels(const Imf::Header& header) {
  for (const Names& names : {Names{"R", "G", "B"}, Names{"X", "Y", "Z"}, Names{"Y"}})
    if (has_all(header, names)) return names;
  throw std::runtime_error("its first part has the channels " + joined_names(header.channels()) +
                           ", not R, G, B or X, Y, Z or Y at full resolution");
}

std::string text_attribute(const Imf::Header& header, const char* name) {
  const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
  return text ? text->value() : "";
}

// Disjoint ascending "FIRST:COUNT", separated by blanks; empty if it is anything else.
std::vector<SampleRange> parsed_ranges(const std::string& text) {
  std::vector<SampleRange> ranges;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    SampleRange range;
    const char* const end = word.data() + word.size();
    const auto first = std::from_chars(word.data(), end, range.first);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != ':') return {};
    const auto count = std::from_chars(first.ptr + 1, end, range.count);
    const std::uint64_t from = ranges.empty() ? 0 : ranges.back().end();
    constexpr std::uint64_t most = std::uint64_t{1} << 33;
    if (count.ec != std::errc() || count.ptr != end || range.first < from || range.first > most || range.count > most)
      return {};
    ranges.push_back(range);
  }
  return ranges;
}

// What is taken grows with what has been read, and no further than to what all will take: a file that claims more than it
// has fails before.
std::vector<float> read_channels(Imf::MultiPartInputFile& file, int part, const Names& names) {
  Imf::InputPart input(file, part);
  const Imath::Box2i window = input.header().dataWindow();
  const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
  const auto height = static_cast<std::uint64_t>(std::int64_t{window.max.y} - window.min.y + 1);
  const std::size_t row = width * names.size();
  const std::uint64_t at_once = std::clamp<std::uint64_t>(MAX_EXR_ROW / (4 * row), 1, ROWS_AT_ONCE);
  std::vector<float> values;
  for (std::uint64_t done = 0; done < height; done += at_once) {
    const std::uint64_t rows = std::min(at_once, height - done);
    const std::size_t first = row * done, end = first + row * rows;
    if (end > values.capacity()) values.reserve(std::min(row * height, std::max(end, 2 * values.capacity())));
    values.resize(end);
    const int top = static_cast<int>(window.min.y + static_cast<std::int64_t>(done));
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < names.size(); ++c)
      buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + first + c, Imath::V2i(window.min.x, top),
                                               static_cast<std::int64_t>(width), static_cast<std::int64_t>(rows),
                                               4 * names.size(), 4 * row));
    input.setFrameBuffer(buffer);
    input.readPixels(top, static_cast<int>(top + static_cast<std::int64_t>(rows) - 1));
  }
  return values;
}

// That of the standard errors of these channels: a part of its own, or a layer of the first.
std::optional<int> error_part(const Imf::MultiPartInputFile& file, const Names& names) {
  for (int i = 0; i < file.parts(); ++i)
    if (has_all(file.header(i), names) && file.header(i).dataWindow() == file.header(0).dataWindow()) return i;
  return std::nullopt;
}

void require_readable(Imf::MultiPartInputFile& file, int part, std::uint64_t size) {
  const Imf::Header& header = file.header(part);
  if (header.hasType() && (header.type() == Imf::DEEPSCANLINE || header.type() == Imf::DEEPTILE))
    throw std::runtime_error("its pixels are deep");
  if (!file.partComplete(part)) throw std::runtime_error("it breaks off");
  check_exr_size(header, size);
}

ImagePlanes read(const std::filesystem::path& path, std::FILE* opened, StandardErrors wanted) {
  FileStream stream(opened);
  const std::uint64_t size = std::filesystem::file_size(path);
  check_exr_headers(stream, size);
  Imf::MultiPartInputFile file(stream, 0, false);
  require_readable(file, 0, size);
  const Imf::Header& header = file.header(0);
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  ImagePlanes image;
  image.width = static_cast<std::uint64_t>(std::int64_t{data.max.x} - data.min.x + 1);
  image.height = static_cast<std::uint64_t>(std::int64_t{data.max.y} - data.min.y + 1);
  image.x = std::int64_t{data.min.x} - display.min.x;
  image.y = std::int64_t{data.min.y} - display.min.y;
  if (image.width * image.height > MAX_COMPARED_PIXELS)
    throw std::runtime_error("it has " + std::to_string(image.width * image.height) + " pixels, more than " +
                             std::to_string(MAX_COMPARED_PIXELS));
  image.channels = colour_channels(header);
  image.values = read_channels(file, 0, image.channels);
  image.ranges = parsed_ranges(text_attribute(header, "sampleRanges"));
  image.sampler = text_attribute(header, "sampler");
  image.seed = text_attribute(header, "seed");
  const std::string rejected = text_attribute(header, "rejectedSamples");
  image.rejected = !rejected.empty() && rejected != "0";
  image.stopped_by_error = text_attribute(header, "stopped") == "error";
  if (wanted == StandardErrors::skip) return image;
  if (const auto* unit = header.findTypedAttribute<Imf::FloatAttribute>("standardErrorUnit"))
    if (std::isfinite(unit->value()) && unit->value() >= 0.0f) image.error_unit = unit->value();
  Names errors = image.channels;
  for (std::string& name : errors) name = "standardError." + name;
  if (const auto part = error_part(file, errors)) {
    require_readable(file, *part, size);
    image.errors = read_channels(file, *part, errors);
  }
  return image;
}

}  // namespace

ImagePlanes read_image_planes(const std::filesystem::path& path, StandardErrors errors) {
  const auto refuse = [&](const std::string& what) -> Error {
    return {Exit::scene, path.string() + ": " + one_line(what) + ", expected an OpenEXR image that is whole"};
  };
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) throw refuse("it is not a regular file");
  const InputFile file = open_input(path);
  if (!file) throw refuse("it cannot be read");
  try {
    return read(path, file.get(), errors);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw refuse(error.what());
  }
}

}  // namespace oclair
