#include "exr_reader.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

namespace {

oclair::ImageWindow window_of(const Imf::Header& header) {
  const Imath::Box2i display = header.displayWindow(), data = header.dataWindow();
  const auto extent = [](int min, int max) { return static_cast<unsigned>(max - min + 1); };
  return {extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), static_cast<unsigned>(data.min.x),
          static_cast<unsigned>(data.min.y),    extent(data.min.x, data.max.x),       extent(data.min.y, data.max.y)};
}

}  // namespace

ExrFile read_exr(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  const Imath::Box2i data = header.dataWindow();
  ExrFile result{};
  result.window = window_of(header);
  result.is_float = true;
  Imf::FrameBuffer pixels;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    std::vector<float>& plane = result.channels[channel.name()];
    plane.resize(std::size_t{result.window.crop_width} * result.window.crop_height);
    pixels.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, plane.data(), data));
    result.is_float = result.is_float && channel.channel().type == Imf::FLOAT;
  }
  file.setFrameBuffer(pixels);
  file.readPixels(data.min.y, data.max.y);

  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    const Imf::Attribute* value = &attribute.attribute();
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(value))
      result.attributes[attribute.name()] = text->value();
    if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(value))
      result.attributes[attribute.name()] = number->value();
    if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(value))
      result.attributes[attribute.name()] = number->value();
  }
  result.has_srgb_chromaticities = Imf::hasChromaticities(header) && Imf::chromaticities(header) == Imf::Chromaticities();
  return result;
}

std::vector<ExrPart> read_exr_parts(const std::filesystem::path& path) {
  Imf::MultiPartInputFile file(path.c_str());
  std::vector<ExrPart> parts;
  for (int i = 0; i < file.parts(); ++i) {
    const Imf::Header& header = file.header(i);
    ExrPart& part = parts.emplace_back();
    if (header.hasName()) part.name = header.name();
    part.window = window_of(header);
    const std::size_t pixels = std::size_t{part.window.crop_width} * part.window.crop_height;
    Imf::FrameBuffer buffer;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      const auto add = [&](auto& plane, Imf::PixelType type) {
        plane.resize(pixels);
        buffer.insert(channel.name(), Imf::Slice::Make(type, plane.data(), header.dataWindow()));
      };
      if (channel.channel().type == Imf::FLOAT) add(part.floats[channel.name()], Imf::FLOAT);
      if (channel.channel().type == Imf::UINT) add(part.integers[channel.name()], Imf::UINT);
    }
    Imf::InputPart input(file, i);
    input.setFrameBuffer(buffer);
    input.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
      const std::string type = attribute.attribute().typeName(), name = attribute.name();
      part.attributes += (type == "string" || type == "int" || type == "float") && name != "name" && name != "type" &&
                         name != "version" && name != "chunkCount" && name != "pixelAspectRatio" &&
                         name != "screenWindowWidth";
    }
  }
  return parts;
}
