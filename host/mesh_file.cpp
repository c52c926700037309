#include "mesh_file.h"

#include <fstream>

namespace oclair {

BufferVector<char> read_mesh_file(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw MeshFileError("it is not a file");
  const auto size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) throw MeshFileError("it cannot be read");
  BufferVector<char> bytes(size);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) throw MeshFileError("it cannot be read");
  return bytes;
}

}  // namespace oclair
