#include "scan.h"

#include <filesystem>

#include "../error.h"
#include "../mesh_file.h"

namespace oclair::bench {

bool scan_is_there() {
  std::error_code error;
  return std::filesystem::exists(scan_file, error);
}

Mesh scan() {
  try {
    return to_world(parse_obj(text_of(read_whole_file(scan_file))), {.face_normals = true});
  } catch (const SceneFileError& fault) {
    throw Error(Exit::scene, std::string(scan_file) + ": " + fault.what());
  }
}

}  // namespace oclair::bench
