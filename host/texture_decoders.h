// The decoders behind texture_file.h, one file of source for each format.
#pragma once

#include <string_view>

#include "texture_file.h"

namespace oclair {

// Throws TextureFileError if an image of that size is refused.
void check_size(ulong width, ulong height);

// Sets the size and makes room for the texels, in the image's format and channels. Throws TextureFileError.
void allocate_texels(Image& image, ulong width, ulong height);

Image decode_png(std::string_view bytes);
Image decode_jpeg(std::string_view bytes);
Image decode_exr(std::string_view bytes);

}  // namespace oclair
