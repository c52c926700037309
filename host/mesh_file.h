// Meshes from files: Wavefront OBJ, PLY and Mitsuba's serialized meshes.
//
// Read by hand, not by Assimp: docs/decisions/mesh-files.md says why.
#pragma once

#include <cstdint>
#include <string_view>

#include "mesh.h"
#include "scene_file.h"

namespace oclair {

// What is wrong with a mesh file; the caller adds which file, and the line of the scene that names it.
struct MeshFileError : SceneFileError {
  using SceneFileError::SceneFileError;
};

// Positions, vertex normals, texture coordinates and faces; corners that share all three indices become one vertex. Everything
// else in the file (materials, groups, lines, points) is skipped. Indices may be negative: counted from the last.
// Throws MeshFileError with "line n: ...".
ObjectMesh parse_obj(std::string_view text);

// ASCII and binary of both byte orders; x y z, nx ny nz, u v (or s t, texture_u texture_v) of the vertices, the index lists of
// the faces, and the attributes of both: r g b (or red green blue) are the attribute "color"; one property NAME_x, or the three
// NAME_x NAME_y NAME_z one after another, are the attribute NAME, likewise with the endings 0 1 2 and 1 2 3, and with r g b the
// attribute NAME_color. Other elements and properties are skipped. Throws MeshFileError.
ObjectMesh parse_ply(std::string_view bytes);

// The shape of that number in a file of Mitsuba's serialized meshes, versions 3 and 4. Like Mitsuba it takes no notice of the
// flag for face normals. Colours become the attribute "vertex_color". Throws MeshFileError.
ObjectMesh parse_serialized(std::string_view file, std::uint64_t shape_index);

}  // namespace oclair
