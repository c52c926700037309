// Image files of textures and environment maps: PNG, JPEG and OpenEXR, told apart by their content.
#pragma once

#include <string_view>

#include "world.h"

namespace oclair {

// What is wrong with an image file; the caller adds which file, and the line of the scene that names it.
struct TextureFileError : SceneFileError {
  using SceneFileError::SceneFileError;
};

// Larger ones are refused: they could ask for any amount of memory.
inline constexpr uint MAX_TEXTURE_SIDE = 65536;
inline constexpr ulong MAX_TEXTURE_PIXELS = ulong{1} << 28;

// PNG: 8 or 16 bits, gray or RGB (fewer bits and palettes become 8 bits, alpha is left out). JPEG: 8 bits, gray or RGB. EXR:
// the channels R, G, B, or else Y: half where all are, otherwise float; the data window is the image. Throws TextureFileError.
Image parse_image(std::string_view bytes);

}  // namespace oclair
