#include "texture_file.h"

#include "texture_decoders.h"

namespace oclair {

void check_size(ulong width, ulong height) {
  if (width == 0 || height == 0) throw TextureFileError("it has no pixels");
  if (width > MAX_TEXTURE_SIDE || height > MAX_TEXTURE_SIDE || width * height > MAX_TEXTURE_PIXELS)
    throw TextureFileError("it has " + std::to_string(width) + "x" + std::to_string(height) +
                           " pixels, at most 65536 along each side and 2^28 in all are expected");
}

void allocate_texels(Image& image, ulong width, ulong height) {
  check_size(width, height);
  constexpr std::size_t SIZES[] = {1, 2, 2, 4};  // TexelFormat
  image.width = static_cast<uint>(width);
  image.height = static_cast<uint>(height);
  image.texels.resize(width * height * image.channels * SIZES[image.format]);
}

Image parse_image(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return decode_png(bytes);
  if (bytes.starts_with("\xff\xd8\xff")) return decode_jpeg(bytes);
  if (bytes.starts_with("\x76\x2f\x31\x01")) return decode_exr(bytes);
  throw TextureFileError("it is not an image of a known format (known: PNG, JPEG, OpenEXR)");
}

}  // namespace oclair
