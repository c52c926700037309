// The readers of files as the program uses them, each as a function of bytes: for the fuzz targets (fuzz/) and for the files
// that these have found.
#pragma once

#include <string>
#include <string_view>

namespace oclair::test {

// The message of the refusal; empty: the bytes were taken, and what the program does with them before a device is asked was
// done as well. Whatever is thrown besides is a fault of the reader, and comes out.
using FileReader = std::string (*)(std::string_view bytes);

// Files that the scene may name: a.obj, a.ply, a.serialized, a.png, a.exr and included.xml.
std::string read_as_scene(std::string_view bytes);
std::string read_as_obj(std::string_view bytes);
std::string read_as_ply(std::string_view bytes);
std::string read_as_serialized(std::string_view bytes);  // its first two shapes
std::string read_as_image(std::string_view bytes);       // of a texture, in any format
std::string read_as_exr(std::string_view bytes);         // as `oclair info` and `oclair compare` do
std::string read_as_checkpoint(std::string_view bytes);  // with its image, and merged with a part that fits

struct NamedReader {
  const char* name;  // of its target, and of the directory in data/fuzz
  FileReader read;
};

inline constexpr NamedReader FILE_READERS[] = {
    {"scene", read_as_scene},           {"obj", read_as_obj},     {"ply", read_as_ply},
    {"serialized", read_as_serialized}, {"image", read_as_image}, {"exr", read_as_exr},
    {"checkpoint", read_as_checkpoint}};

}  // namespace oclair::test
