// <shape>: obj, ply, serialized, rectangle, cube, sphere, disk, cylinder, with the BSDF and the area light on it; shapegroup
// and instance.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bsdf_reader.h"
#include "buffer_vector.h"
#include "document.h"
#include "texture_reader.h"
#include "world.h"

namespace oclair {

struct ShapeGroup {
  std::vector<WorldShape> shapes;
  std::uint64_t triangle_count = 0, quadric_count = 0;
};

struct ShapeInstance {
  const ShapeGroup* group;
  glm::dmat4 to_world;
  std::string where;  // "file:line" of its transform
};

// What shapes share with each other while a scene is read.
struct ShapeContext {
  KnownBsdfs bsdfs;
  std::optional<SurfaceMaterials> default_materials[2];  // of shapes that do not emit, and that do
  std::set<std::uint32_t> used_lights;                   // area lights that lie on a shape
  std::uint64_t triangle_count = 0, quadric_count = 0;
  std::map<std::uint32_t, ShapeGroup> groups;            // by element
  std::vector<ShapeInstance> instances;                  // all are counted before the first is copied
  std::string serialized_file;                           // the last one: it may hold many shapes
  BufferVector<char> serialized_bytes;
};

// Appends the shape, its materials and its warnings to the world. Throws Error(Exit::scene).
void read_shape(Document& document, std::uint32_t element, ShapeContext& context, World& world);

// Then appends the shapes of the instances that were read. Throws Error(Exit::scene).
void place_instances(const ShapeContext& context, World& world);

}  // namespace oclair
