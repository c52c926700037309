// Reads back what write_exr has written.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "../host/image.h"

struct ExrFile {
  oclair::ImageWindow window;
  std::map<std::string, std::vector<float>> channels;  // a plane each
  std::map<std::string, std::variant<std::string, int, float>> attributes;
  bool is_float;  // 32 bits in the file, all channels
  bool has_srgb_chromaticities;
};

ExrFile read_exr(const std::filesystem::path& path);
