// The settings file: what `oclair tune --write` recommends and `oclair render --settings` uses. docs/tune.md shows one.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "choices.h"

namespace oclair {

struct SettingsFile {
  std::string program;     // that measured them
  std::string scene;       // name of the scene file that they were measured on
  std::string scene_hash;  // of all its files
  Choices choices;
  std::vector<std::pair<std::string, std::string>> measured;  // names and numbers: what tune found of all of them together; what is no
                                                              // finite number is not written
};

// Throws Error(Exit::scene) that begins with FILE:LINE if it is no JSON, or has a name or a value that is not known, and with FILE if it
// cannot be read or is larger than 1 MiB.
SettingsFile read_settings(const std::filesystem::path& file);

// Throws Error(Exit::render_failed) if it cannot be written.
void write_settings(const std::filesystem::path& file, const SettingsFile& settings);

}  // namespace oclair
