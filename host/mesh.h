// Triangle meshes from the file's own space into the world.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "world.h"

namespace oclair {

// A mesh as its file says it. Indices are below the number of positions, coordinates finite.
struct ObjectMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  // one per position, of any length but 0, or none
  std::vector<glm::dvec2> uvs;      // one per position, or none
  std::vector<glm::uvec3> triangles;
  std::vector<MeshAttribute> attributes;
  std::size_t concave_polygons = 0;     // that the fan of append_polygon covers wrongly
  std::size_t vertices_without_uv = 0;  // of a mesh whose other vertices have them: (0, 0)
};

struct MeshOptions {
  glm::dmat4 to_world{1.0};   // invertible
  bool face_normals = false;  // forget the vertex normals
  bool flip_normals = false;
};

// Cuts a polygon into the fan of triangles around its first corner, as Mitsuba does. Corners: at least 3.
void append_polygon(ObjectMesh& mesh, std::span<const std::uint32_t> corners);

// The mesh in world space. Without vertex normals and without face_normals, normals are computed there: the mean of the
// normals of the adjacent triangles weighted by their angles (Thuermer and Wuethrich 1998). All three throw
// std::range_error if a coordinate overflows.
Mesh to_world(ObjectMesh mesh, const MeshOptions& options);

// [-1, 1]^2 at z = 0 and [-1, 1]^3, flat; the front of the rectangle is where to_world sends the normal +z, that of the cube
// outside, whatever to_world mirrors. flip_normals turns them; face_normals changes nothing.
Mesh rectangle_mesh(const MeshOptions& options);
Mesh cube_mesh(const MeshOptions& options);

}  // namespace oclair
