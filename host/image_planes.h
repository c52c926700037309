// The colour of an OpenEXR file and its standard errors, in memory, to be compared. The file may be anyone's and is not
// trusted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sample_range.h"

namespace oclair {

struct ImagePlanes {
  std::uint64_t width = 0, height = 0;  // of the pixels that are stored
  std::int64_t x = 0, y = 0;            // of their first one, from the corner of the film
  std::vector<std::string> channels;    // R G B, or X Y Z, or Y
  std::vector<float> values;            // pixel by pixel, row by row, in the order of the channels
  std::vector<float> errors;            // standard errors of the values; empty: not told, or not asked for
  double error_unit = 0.0;              // of the standard errors (film.h), as the header has it; 0: not told
  std::vector<SampleRange> ranges;      // of the samples of a pixel, as the header has them; empty: not told
  std::string sampler, seed;            // as the header has them; empty: not told
  bool rejected = false;                // the header says that some samples were
  bool stopped_by_error = false;        // the header says that the number of samples follows from what they were

  std::size_t pixels() const { return static_cast<std::size_t>(width * height); }
};

inline constexpr std::uint64_t MAX_COMPARED_PIXELS = std::uint64_t{1} << 28;

enum class StandardErrors { read, skip };

// Of the first part the colour; the part (or layer) `standardError`, if there is one for it. Throws Error(Exit::scene).
ImagePlanes read_image_planes(const std::filesystem::path& path, StandardErrors errors = StandardErrors::read);

}  // namespace oclair
