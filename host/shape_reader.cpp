#include "shape_reader.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include "light_reader.h"
#include "mesh_file.h"
#include "property.h"
#include "quadric.h"
#include "transform.h"

namespace oclair {

namespace {

constexpr std::uint64_t MAX_TRIANGLES = (std::uint64_t{1} << 31) - 1;  // ids have 31 bits

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

Mesh mesh_from_file(const Document& document, Element& element, World& world) {
  boolean_property(element, "flip_tex_coords", false);  // nothing has a texture
  const auto name = string_property(element, "filename");
  if (!name) refuse(element.where, describe(element) + " lacks <string name=\"filename\">");
  const std::string at = where_is(element, "filename");
  const auto file = find_file(document.search_path, *name).string();
  if (file.empty()) refuse(at, "no mesh file \"" + *name + "\" beside the scene or on its search path");
  if (std::find(world.files.begin(), world.files.end(), file) == world.files.end()) world.files.push_back(file);
  const auto options = mesh_options(element);
  try {
    const std::string bytes = read_mesh_file(file);
    const ObjectMesh mesh = element.type == "obj" ? parse_obj(bytes) : parse_ply(bytes);
    if (mesh.concave_polygons)
      world.warnings.push_back(at + ": " + file + ": " + std::to_string(mesh.concave_polygons) +
                               " polygons are concave or bent; each is cut into a fan around its first corner");
    return to_world(mesh, options);
  } catch (const MeshFileError& error) {
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
      read_area_light(document, child.element, context.textures, world, shape);
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

}  // namespace

void read_shape(Document& document, std::uint32_t index, ShapeContext& context, World& world) {
  auto& element = document.elements[index];
  WorldShape shape;
  shape.where = element.where;
  if (element.type == "sphere" || element.type == "disk" || element.type == "cylinder") {
    place_quadric(element, shape);
  } else if (element.type == "obj" || element.type == "ply") {
    shape.mesh = mesh_from_file(document, element, world);
  } else if (element.type == "rectangle" || element.type == "cube") {
    const auto options = mesh_options(element);
    try {
      shape.mesh = element.type == "cube" ? cube_mesh(options) : rectangle_mesh(options);
    } catch (const std::range_error& error) {
      refuse(where_is(element, "to_world"), describe(element) + ": " + error.what());
    }
  } else {
    refuse(element.where,
           describe(element) + " is not supported (supported: cube, cylinder, disk, obj, ply, rectangle, sphere)");
  }
  context.triangle_count += shape.mesh.triangles.size();
  if (context.triangle_count > MAX_TRIANGLES || shape.mesh.positions.size() > MAX_TRIANGLES)
    refuse(element.where, "the scene has more than 2^31 - 1 triangles");
  read_children(document, index, context, world, shape);
  world.shapes.push_back(std::move(shape));
}

}  // namespace oclair
