// The files that a scene reads. They are opened here alone, so that each leaves its mark in the hash of the scene.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "buffer_vector.h"

namespace oclair {

struct SceneFile {
  std::string path;
  std::string name;      // as the scene writes it; of the scene's own file: empty
  std::string checksum;  // of the bytes that were read, see xxh3.h
};

// What is wrong with a file; the caller adds which one, and the line of the scene that names it.
struct SceneFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The whole file. Throws SceneFileError.
BufferVector<char> read_whole_file(const std::filesystem::path& file);

// The same, listed unless it is in the list already. A file that is read twice must have stayed as it was.
BufferVector<char> read_scene_file(const std::filesystem::path& file, const std::string& name, std::vector<SceneFile>& files);

inline std::string_view text_of(const BufferVector<char>& bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace oclair
