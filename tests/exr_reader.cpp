#include "exr_reader.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

ExrFile read_exr(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  const Imath::Box2i display = header.displayWindow(), data = header.dataWindow();
  const auto extent = [](int min, int max) { return static_cast<unsigned>(max - min + 1); };

  ExrFile result{};
  result.window = {extent(display.min.x, display.max.x), extent(display.min.y, display.max.y),
                   static_cast<unsigned>(data.min.x),    static_cast<unsigned>(data.min.y),
                   extent(data.min.x, data.max.x),       extent(data.min.y, data.max.y)};
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
