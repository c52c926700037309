#include "scene_file.h"

#include <algorithm>
#include <fstream>

#include "xxh3.h"

namespace oclair {

BufferVector<char> read_whole_file(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw SceneFileError("it is not a file");
  const auto size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) throw SceneFileError("it cannot be read");
  BufferVector<char> bytes(size);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) throw SceneFileError("it cannot be read");
  return bytes;
}

BufferVector<char> read_scene_file(const std::filesystem::path& file, const std::string& name, std::vector<SceneFile>& files) {
  BufferVector<char> bytes = read_whole_file(file);
  const std::string checksum = xxh3_digits(bytes.data(), bytes.size());
  const auto known = std::find_if(files.begin(), files.end(), [&](const SceneFile& f) { return f.path == file.string(); });
  if (known == files.end()) files.push_back({file.string(), name, checksum});
  else if (known->checksum != checksum) throw SceneFileError("it has changed while the scene was read");
  return bytes;
}

}  // namespace oclair
