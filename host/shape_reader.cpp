#include "shape_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "instance.h"
#include "light_reader.h"
#include "mesh_file.h"
#include "property.h"
#include "quadric.h"
#include "transform.h"

namespace oclair {

namespace {

constexpr std::uint64_t MAX_TRIANGLES = (std::uint64_t{1} << 31) - 1;  // ids have 31 bits
constexpr std::uint64_t MAX_QUADRICS = std::uint64_t{1} << LEAF_COUNT_SHIFT;

glm::dmat4 to_world_of(Element& element) {
  const auto matrix = transform_property(element, "to_world").value_or(glm::dmat4(1.0));
  if (!is_invertible(matrix)) refuse(where_is(element, "to_world"), "\"to_world\" of " + describe(element) + " flattens it");
  return matrix;
}

MeshOptions mesh_options(Element& element) {
  MeshOptions options;
  options.to_world = to_world_of(element);
  options.face_normals = boolean_property(element, "face_normals", false);
  options.flip_normals = boolean_property(element, "flip_normals", false);
  return options;
}

ObjectMesh parse_mesh(Element& element, const std::string& file, const std::string& name, ShapeContext& context, World& world) {
  const auto bytes = [&] { return read_scene_file(file, name, world.files); };
  if (element.type == "obj") return parse_obj(text_of(bytes()));
  if (element.type == "ply") return parse_ply(text_of(bytes()));
  constexpr std::int64_t MAX_INDEX = std::numeric_limits<std::uint32_t>::max();
  const std::int64_t shape_index = integer_property(element, "shape_index", 0, 0, MAX_INDEX);
  if (context.serialized_file != file) {
    context.serialized_bytes = bytes();
    context.serialized_file = file;
  }
  return parse_serialized(text_of(context.serialized_bytes), static_cast<std::uint64_t>(shape_index));
}

Mesh mesh_from_file(const Document& document, Element& element, ShapeContext& context, World& world) {
  const bool flip_uv = element.type != "serialized" && boolean_property(element, "flip_tex_coords", element.type == "obj");
  const auto name = string_property(element, "filename");
  if (!name) refuse(element.where, describe(element) + " lacks <string name=\"filename\">");
  const std::string at = where_is(element, "filename");
  const auto file = find_file(document.search_path, *name).string();
  if (file.empty()) refuse(at, "no mesh file \"" + *name + "\" beside the scene or on its search path");
  const auto options = mesh_options(element);
  try {
    ObjectMesh mesh = parse_mesh(element, file, *name, context, world);
    if (mesh.concave_polygons)
      world.warnings.push_back(at + ": " + file + ": " + std::to_string(mesh.concave_polygons) +
                               " polygons are concave or bent; each is cut into a fan around its first corner");
    if (mesh.vertices_without_uv)
      world.warnings.push_back(at + ": " + file + ": " + std::to_string(mesh.vertices_without_uv) +
                               " vertices have no texture coordinates, the others have; they get (0, 0)");
    if (flip_uv)
      for (auto& uv : mesh.uvs) uv.y = 1.0 - uv.y;
    return to_world(std::move(mesh), options);
  } catch (const SceneFileError& error) {
    refuse(at, file + ": " + error.what());
  } catch (const std::range_error& error) {
    refuse(at, file + ": " + error.what());
  } catch (const std::bad_alloc&) {
    refuse(at, file + ": there is not enough memory for it");
  }
}

glm::dmat4 cylinder_matrix(Element& element) {
  const auto p0 = point_property(element, "p0").value_or(glm::dvec3(0.0)),
             p1 = point_property(element, "p1").value_or(glm::dvec3(0.0, 0.0, 1.0));
  const double radius = number_property(element, "radius", 1.0), length = glm::length(p1 - p0);
  if (!(length > 0.0) || !std::isfinite(length))
    refuse(where_is(element, "p1"), "\"p0\" and \"p1\" of " + describe(element) + " coincide or lie too far apart");
  if (radius == 0.0) refuse(where_is(element, "radius"), "\"radius\" of " + describe(element) + " is zero");
  const glm::dmat4 frame(frame_around((p1 - p0) / length));
  return to_world_of(element) * translation(p0) * frame * scaling({std::abs(radius), std::abs(radius), length});
}

glm::dmat4 sphere_matrix(Element& element) {
  const double radius = number_property(element, "radius", 1.0);
  if (radius == 0.0) refuse(where_is(element, "radius"), "\"radius\" of " + describe(element) + " is zero");
  return to_world_of(element) * translation(point_property(element, "center").value_or(glm::dvec3(0.0))) *
         scaling(glm::dvec3(radius));
}

void place_quadric(Element& element, WorldShape& shape) {
  std::optional<PlacedQuadric> quadric;
  if (element.type == "sphere") {
    shape.geometry = Geometry::sphere;
    quadric = place_sphere(sphere_matrix(element));
    if (!quadric)
      refuse(where_is(element, "to_world"),
             "\"to_world\" of " + describe(element) +
                 " shears it or scales it differently along its axes, which is not supported");
  } else if (element.type == "cylinder") {
    shape.geometry = Geometry::cylinder;
    quadric = place_cylinder(cylinder_matrix(element));
    if (!quadric)
      refuse(where_is(element, "to_world"),
             "\"to_world\" of " + describe(element) +
                 " shears it or scales it differently across its axis, which is not supported");
  } else {
    shape.geometry = Geometry::disk;
    quadric = place_disk(to_world_of(element));
  }
  shape.to_world = quadric->to_world;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      if (!std::isfinite(shape.to_world[column][row])) refuse(element.where, describe(element) + " lies too far away");
  shape.flip_normals = boolean_property(element, "flip_normals", false) != quadric->inside_out;
}

// The BSDF and the light nested in a shape.
void read_children(Document& document, std::uint32_t index, ShapeContext& context, World& world, WorldShape& shape) {
  const auto& element = document.elements[index];
  std::optional<SurfaceMaterials> materials;
  for (const auto& child : element.children) {
    auto& nested = document.elements[child.element];
    if (nested.tag == "bsdf") {
      if (materials) refuse(child.where, describe(element) + " has more than one <bsdf>");
      materials = read_bsdf(document, child.element, context.bsdfs, world);
    } else if (nested.tag == "emitter") {
      if (shape.radiance) refuse(child.where, describe(element) + " has more than one <emitter>");
      if (nested.type != "area")
        refuse(child.where, describe(nested) + " is not supported in " + describe(element) + " (supported: area)");
      if (!context.used_lights.insert(child.element).second)
        refuse(child.where, describe(nested) + " at " + nested.where + " already lies on another shape");
      read_area_light(document, child.element, context.bsdfs.textures, world, shape);
    } else {
      refuse(child.where, describe(nested) + " is not supported in " + describe(element) + " (supported: bsdf, emitter)");
    }
  }
  if (!materials) {
    // Mitsuba: diffuse of reflectance 0.5, but black where it emits.
    auto& shared = context.default_materials[shape.radiance.has_value()];
    if (!shared) shared = add_diffuse(world, shape.radiance ? 0.0 : 0.5);
    materials = *shared;
  }
  shape.material_front = materials->front;
  shape.material_back = materials->back;
}

// What is not a group or an instance.
WorldShape read_single(Document& document, std::uint32_t index, ShapeContext& context, World& world) {
  auto& element = document.elements[index];
  WorldShape shape;
  shape.where = element.where;
  if (element.type == "sphere" || element.type == "disk" || element.type == "cylinder") {
    place_quadric(element, shape);
  } else if (element.type == "obj" || element.type == "ply" || element.type == "serialized") {
    shape.mesh = mesh_from_file(document, element, context, world);
  } else if (element.type == "rectangle" || element.type == "cube") {
    const auto options = mesh_options(element);
    try {
      shape.mesh = element.type == "cube" ? cube_mesh(options) : rectangle_mesh(options);
    } catch (const std::range_error& error) {
      refuse(where_is(element, "to_world"), describe(element) + ": " + error.what());
    }
  } else {
    refuse(element.where, describe(element) + " is not supported (supported: cube, cylinder, disk, instance, obj, ply, "
                                              "rectangle, serialized, shapegroup, sphere)");
  }
  if (shape.mesh.triangles.size() > MAX_TRIANGLES || shape.mesh.positions.size() > MAX_TRIANGLES)
    refuse(element.where, "the scene has more than 2^31 - 1 triangles");
  read_children(document, index, context, world, shape);
  return shape;
}

void count_primitives(const std::string& where, std::uint64_t triangles, std::uint64_t quadrics, ShapeContext& context) {
  context.triangle_count += triangles;
  context.quadric_count += quadrics;
  if (context.triangle_count > MAX_TRIANGLES) refuse(where, "the scene has more than 2^31 - 1 triangles");
  if (context.quadric_count > MAX_QUADRICS) refuse(where, "the scene has more than 2^27 spheres, disks and cylinders");
}

const ShapeGroup& read_group(Document& document, std::uint32_t index, ShapeContext& context, World& world) {
  const auto known = context.groups.find(index);
  if (known != context.groups.end()) return known->second;
  const auto& element = document.elements[index];
  ShapeGroup group;
  for (const auto& child : element.children) {
    const auto& nested = document.elements[child.element];
    if (nested.tag != "shape" || nested.type == "shapegroup" || nested.type == "instance")
      refuse(child.where, describe(nested) + " is not supported in " + describe(element) + " (supported: other shapes)");
    auto& shape = group.shapes.emplace_back(read_single(document, child.element, context, world));
    if (shape.radiance) refuse(child.where, describe(nested) + " emits, which is not supported in " + describe(element));
    group.triangle_count += shape.mesh.triangles.size();
    group.quadric_count += shape.geometry != Geometry::mesh;
    if (group.triangle_count > MAX_TRIANGLES) refuse(child.where, describe(element) + " has more than 2^31 - 1 triangles");
  }
  return context.groups.emplace(index, std::move(group)).first->second;
}

void read_instance(Document& document, std::uint32_t index, ShapeContext& context, World& world) {
  auto& element = document.elements[index];
  const ShapeGroup* group = nullptr;
  for (const auto& child : element.children) {
    const auto& nested = document.elements[child.element];
    if (nested.type != "shapegroup" || group)
      refuse(child.where, describe(nested) + " is not supported in " + describe(element) + " (supported: one shapegroup)");
    group = &read_group(document, child.element, context, world);
  }
  if (!group) refuse(element.where, describe(element) + " lacks <ref> to a shapegroup");
  count_primitives(element.where, group->triangle_count, group->quadric_count, context);
  context.instances.push_back({group, to_world_of(element), where_is(element, "to_world")});
}

}  // namespace

void read_shape(Document& document, std::uint32_t index, ShapeContext& context, World& world) {
  const auto& element = document.elements[index];
  if (element.type == "shapegroup") {
    read_group(document, index, context, world);
  } else if (element.type == "instance") {
    read_instance(document, index, context, world);
  } else {
    auto shape = read_single(document, index, context, world);
    count_primitives(element.where, shape.mesh.triangles.size(), shape.geometry != Geometry::mesh, context);
    world.shapes.push_back(std::move(shape));
  }
}

void place_instances(const ShapeContext& context, World& world) {
  for (const auto& instance : context.instances)
    for (const auto& shape : instance.group->shapes) {
      const std::string what = "\"to_world\" of <shape type=\"instance\">";
      try {
        auto copy = instance_of(shape, instance.to_world);
        if (!copy)
          refuse(instance.where, what + " shears the sphere or cylinder at " + shape.where +
                                     " or scales it differently along its axes, which is not supported");
        world.shapes.push_back(std::move(*copy));
      } catch (const std::range_error& error) {
        refuse(instance.where, what + ": the shape at " + shape.where + ": " + error.what());
      }
    }
}

}  // namespace oclair
