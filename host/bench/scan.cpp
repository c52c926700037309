#include "scan.h"

#include <filesystem>

#include "../error.h"
#include "../mesh_file.h"

namespace oclair::bench {

std::optional<Mesh> scan() {
  std::error_code error;
  if (!std::filesystem::exists(scan_file, error)) return std::nullopt;
  try {
    return to_world(parse_obj(read_mesh_file(scan_file)), {.face_normals = true});
  } catch (const MeshFileError& fault) {
    throw Error(Exit::scene, std::string(scan_file) + ": " + fault.what());
  }
}

}  // namespace oclair::bench
