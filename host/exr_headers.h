// The headers of OpenEXR files from anyone. OpenEXR takes memory for whatever size an attribute claims before it reads it;
// headers that have passed here claim no more than their file has.
#pragma once

#include <ImfIO.h>

#include <cstdint>

namespace oclair {

// Goes through all headers, from the beginning of the stream, which has `size` bytes, and back to it. Throws
// std::runtime_error.
void check_exr_headers(Imf::IStream& stream, std::uint64_t size);

}  // namespace oclair
