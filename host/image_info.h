// What an OpenEXR file holds, whoever has written it. The file is not trusted: whatever it claims is checked before memory
// is taken for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace oclair {

// Over the finite values; without one min is infinite.
struct ChannelInfo {
  std::string name, type;  // half, float or uint
  double min = std::numeric_limits<double>::infinity(), mean = 0.0, max = -std::numeric_limits<double>::infinity();
  std::uint64_t finite = 0, infinite = 0, nan = 0;
};

struct PartInfo {
  std::string name;  // empty: has none
  std::string type;  // scanlineimage, tiledimage, deepscanline or deeptile; of deep parts the values are not looked at
  std::uint64_t width = 0, height = 0;  // of the pixels that are stored
  std::int64_t x = 0, y = 0;            // of their first one, from the corner of the film
  std::uint64_t film_width = 0, film_height = 0;
  std::vector<ChannelInfo> channels;
  std::vector<std::pair<std::string, std::string>> attributes;  // but for those that OpenEXR itself needs
};

// By its first four bytes, whatever its name; false if it cannot be read.
bool is_exr(const std::filesystem::path& path);

// Throws Error(Exit::scene): a broken file.
std::vector<PartInfo> read_image_info(const std::filesystem::path& path);

}  // namespace oclair
