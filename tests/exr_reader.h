// Reads back what write_exr has written.
#pragma once

#include <cstdint>
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

// The first part alone, as a reader sees it that knows nothing of parts.
ExrFile read_exr(const std::filesystem::path& path);

struct ExrPart {
  std::string name;
  oclair::ImageWindow window;
  std::map<std::string, std::vector<float>> floats;            // the channels of type FLOAT
  std::map<std::string, std::vector<std::uint32_t>> integers;  // those of type UINT
  std::size_t attributes;  // strings and numbers of the header that OpenEXR does not require
};

std::vector<ExrPart> read_exr_parts(const std::filesystem::path& path);
