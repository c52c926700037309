// The headers of OpenEXR files from anyone. OpenEXR takes memory for whatever size an attribute claims before it reads it;
// headers that have passed here claim no more than their file has.
#pragma once

#include <ImfHeader.h>
#include <ImfIO.h>

#include <cstdint>

namespace oclair {

inline constexpr std::uint64_t MAX_EXR_ROW = std::uint64_t{1} << 24;  // bytes of a row of pixels, all channels as 32 bits

// Goes through all headers, from the beginning of the stream, which has `size` bytes, and back to it. Throws
// std::runtime_error.
void check_exr_headers(Imf::IStream& stream, std::uint64_t size);

// Before anything is allocated for the pixels of a part: its rows of pixels, chunks of rows and rows of tiles are no larger than
// OpenEXR may take memory for, and the file, of `size` bytes, can hold where its tiles begin. Its data window is not empty,
// and its type is told. Throws std::runtime_error.
void check_exr_size(const Imf::Header& header, std::uint64_t size);

}  // namespace oclair
