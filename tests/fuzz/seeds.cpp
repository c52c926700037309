// Writes files that the readers accept, as seeds of the fuzz targets: each in the directory of its target.
// usage: fuzz_seeds DIRECTORY
#include <ImfRgbaFile.h>
#include <ImfTiledOutputFile.h>

#include <filesystem>

#include "../../host/image.h"
#include "../checkpoint_cases.h"
#include "../encoders.h"
#include "../files.h"

using namespace oclair;
using namespace oclair::test;

namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> counted(std::size_t count) {
  std::vector<std::uint8_t> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<std::uint8_t>(7 * i);
  return result;
}

void write_pngs(const fs::path& directory) {
  for (const bool interlaced : {false, true}) {
    const std::string suffix = interlaced ? "_interlaced.png" : ".png";
    put(directory / ("gray4" + suffix),
        png_bytes(5, 3, PNG_COLOR_TYPE_GRAY, 4, std::vector<std::uint8_t>(15, 9), interlaced));
    put(directory / ("palette" + suffix),
        png_bytes(5, 3, PNG_COLOR_TYPE_PALETTE, 2, std::vector<std::uint8_t>(15, 3), interlaced));
    put(directory / ("rgb8" + suffix), png_bytes(5, 3, PNG_COLOR_TYPE_RGB, 8, counted(45), interlaced));
    put(directory / ("rgba16" + suffix), png_bytes(5, 3, PNG_COLOR_TYPE_RGB_ALPHA, 16, counted(120), interlaced));
  }
}

void write_jpegs(const fs::path& directory) {
  for (const bool progressive : {false, true}) {
    const std::string suffix = progressive ? "_progressive.jpg" : ".jpg";
    put(directory / ("gray" + suffix), jpeg_bytes(20, 11, JCS_GRAYSCALE, 1, counted(220), progressive));
    put(directory / ("rgb" + suffix), jpeg_bytes(17, 11, JCS_RGB, 3, counted(561), progressive));
  }
}

std::string tiled_exr() {
  Imf::Header header(20, 12);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.setTileDescription(Imf::TileDescription(8, 4, Imf::MIPMAP_LEVELS));
  std::vector<Imath::half> values(240, Imath::half(0.5f));
  ByteSink sink;
  {
    Imf::TiledOutputFile file(sink, header, 0);
    Imf::FrameBuffer frame;
    frame.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), 2, 40));
    file.setFrameBuffer(frame);
    for (int level = 0; level < file.numLevels(); ++level)
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  }
  return sink.text;
}

// Luminance, and chroma with a sample for each square of four pixels.
std::string chroma_exr() {
  const std::vector<Imf::Rgba> pixels(8 * 6, Imf::Rgba(0.5f, 0.25f, 1.0f));
  ByteSink sink;
  {
    Imf::RgbaOutputFile file(sink, Imf::Header(8, 6), Imf::WRITE_YC, 0);
    file.setFrameBuffer(pixels.data(), 1, 8);
    file.writePixels(6);
  }
  return sink.text;
}

void write_exrs(const fs::path& directory) {
  const auto values = [](std::size_t count) {
    std::vector<float> result(count);
    for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<float>(i % 7) * 0.25f;
    return result;
  };
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    const std::vector<float> v = values(24 * 20);
    put(directory / ("rgb" + std::to_string(compression) + ".exr"),
        exr_bytes(24, 20, {{"R", Imf::HALF, v}, {"G", Imf::HALF, v}, {"B", Imf::FLOAT, v}},
                  static_cast<Imf::Compression>(compression)));
  }
  put(directory / "chroma.exr", chroma_exr());
  put(directory / "tiled.exr", tiled_exr());
  const auto part = [](const std::string& name, float value) {
    return ImagePart{name, {name + ".Y"}, ValuesOfPixel<float>([value](std::size_t, auto pixel) { pixel[0] = value; })};
  };
  write_exr(directory / "parts.exr", {6, 6, 1, 2, 3, 2}, {part("first", 0.5f), part("second", 1e30f)}, {{"seed", "7"}});
}

void write_checkpoints(const fs::path& directory) {
  write_checkpoint(directory / "moments", random_checkpoint({{0, 48}, {64, 40}}, 1));
  Checkpoint plain = random_checkpoint({{16, 1}}, 2, false);
  plain.layers.clear();
  plain.identity = {{"not UTF-8", "\xff\xfe\x80"}};
  write_checkpoint(directory / "plain", plain);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const fs::path top = arguments[1];
  for (const char* name : {"image", "exr", "checkpoint"}) fs::create_directories(top / name);
  write_pngs(top / "image");
  write_jpegs(top / "image");
  write_exrs(top / "image");
  write_exrs(top / "exr");
  write_checkpoints(top / "checkpoint");
}
