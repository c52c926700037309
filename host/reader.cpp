#include "reader.h"

#include <algorithm>
#include <new>
#include <set>
#include <utility>

#include "document.h"
#include "error.h"
#include "integrator_reader.h"
#include "light_reader.h"
#include "property.h"
#include "sensor_reader.h"
#include "shape_reader.h"

namespace oclair {

namespace {

void read_children(Document& document, World& world, const std::optional<glm::uvec2>& film_size) {
  ShapeContext context;
  bool has_integrator = false, has_sensor = false;
  std::set<std::uint32_t> seen;
  const auto children = document.elements[0].children;
  for (const auto& child : children) {
    auto& element = document.elements[child.element];
    if (!seen.insert(child.element).second && element.tag != "bsdf")
      refuse(child.where, describe(element) + " at " + element.where + " is already part of the scene");
    if (element.tag == "shape") {
      read_shape(document, child.element, context, world);
    } else if (element.tag == "bsdf") {
      read_bsdf(document, child.element, context.bsdfs, world);
    } else if (element.tag == "emitter") {
      // An area light that stands alone to be referred to by a shape shines there.
      if (element.type != "area") read_light(document, child.element, context.bsdfs.textures, world);
    } else if (element.tag == "texture") {
      read_texture(document, child.element, context.bsdfs.textures, world);
    } else if (element.tag == "integrator") {
      if (std::exchange(has_integrator, true)) refuse(child.where, "<scene> has more than one <integrator>");
      read_integrator(document, child.element, world);
    } else if (element.tag == "sensor") {
      if (!std::exchange(has_sensor, true))
        read_sensor(document, child.element, film_size, world);
      else
        world.warnings.push_back(child.where + ": the scene is seen by its first <sensor>, this one is not used");
    } else {
      refuse(child.where,
             describe(element) + " is not supported in <scene> (supported: bsdf, emitter, integrator, sensor, shape, texture)");
    }
  }
  place_instances(context, world);
  const std::string& where = document.elements[0].where;
  if (!has_sensor) refuse(where, "<scene> has no <sensor>");
  if (!has_integrator) world.warnings.push_back(where + ": <scene> has no <integrator>; path with its defaults is used");
}

}  // namespace

World read_scene(const std::filesystem::path& file, const Definitions& definitions, const ReadOptions& options) {
  const auto begin = [&](const char* phase) {
    if (options.begin_phase) options.begin_phase(phase);
  };
  try {
    begin("parse");
    Document document = read_document(file, definitions);
    World world;
    world.sampler = SAMPLER_SOBOL;  // docs/decisions/sampler.md; of a <sampler>, only the count and the seed are asked for
    world.files = document.files;
    world.warnings = document.warnings;
    begin("meshes");
    read_children(document, world, options.film_size);
    const bool has_light = !world.lights.empty() || std::any_of(world.shapes.begin(), world.shapes.end(),
                                                                [](const WorldShape& s) { return s.radiance.has_value(); });
    if (!has_light) world.warnings.push_back(document.elements[0].where + ": <scene> has no light: the image will be black");
    const auto unasked = unasked_properties(document);
    world.warnings.insert(world.warnings.end(), unasked.begin(), unasked.end());
    return world;
  } catch (const std::bad_alloc&) {
    throw Error(Exit::scene, file.string() + ": there is not enough memory for the scene");
  }
}

}  // namespace oclair
