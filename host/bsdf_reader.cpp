#include "bsdf_reader.h"

#include <sstream>

#include "conductors.h"
#include "property.h"
#include "refractive_indices.h"

namespace oclair {

namespace {

constexpr double MAX_INDEX = 1e6;

packed_float3 packed(glm::dvec3 v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

void refuse_children(const Element& element) {
  if (!element.children.empty()) refuse(element.children[0].where, "nothing may be nested in " + describe(element));
}

packed_float3 colour(Element& element, const std::string& name, double missing) {
  return packed(reflectance_property(element, name, missing));
}

double number_between(Element& element, const std::string& name, double missing, double least, double greatest,
                      const char* range) {
  const double value = number_property(element, name, missing);
  if (!(value >= least && value <= greatest))
    refuse(where_is(element, name), "\"" + name + "\" of " + describe(element) + " lies outside " + range);
  return value;
}

Material diffuse(Element& element) {
  Material material{};
  material.kind = MATERIAL_DIFFUSE;
  material.reflectance = colour(element, "reflectance", 0.5);
  return material;
}

// Mitsuba 0.6's: alpha is the roughness of a Beckmann distribution, sigma that of Oren and Nayar.
constexpr double SIGMA_OF_ALPHA = 0.70710678118654752;

Material rough_diffuse(Element& element) {
  Material material{};
  material.kind = boolean_property(element, "use_fast_approx", false) ? MATERIAL_OREN_NAYAR_FAST : MATERIAL_OREN_NAYAR;
  material.reflectance = colour(element, "reflectance", 0.5);
  material.roughness = static_cast<float>(SIGMA_OF_ALPHA * number_between(element, "alpha", 0.2, 0.0, 2.0, "[0, 2]"));
  return material;
}

void require_number(Element& element, const std::string& name, double missing, double only) {
  const double value = number_property(element, name, missing);
  if (value == only) return;
  std::ostringstream text;
  text << "\"" << name << "\" of " << describe(element) << " is " << value << (has_property(element, name) ? "" : " by default")
       << ", which is not supported (supported: " << only << ")";
  refuse(where_is(element, name), text.str());
}

// The diffuse part of Disney's model alone: all the others must be off. `specular`, or `eta` in its place, is on by default.
Material principled(Element& element) {
  if (has_property(element, "eta")) {
    if (has_property(element, "specular"))
      refuse(where_is(element, "eta"), "\"eta\" of " + describe(element) + " excludes \"specular\"");
    require_number(element, "eta", 1.0, 1.0);
  } else {
    require_number(element, "specular", 0.5, 0.0);
  }
  for (const char* name : {"metallic", "spec_trans", "flatness", "sheen", "clearcoat", "anisotropic", "spec_tint", "sheen_tint",
                           "clearcoat_gloss"})
    require_number(element, name, 0.0, 0.0);
  for (const char* name : {"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"})
    number_property(element, name, 1.0);  // of its noise alone
  Material material{};
  material.kind = MATERIAL_DISNEY;
  material.reflectance = colour(element, "base_color", 0.5);
  material.roughness = static_cast<float>(number_between(element, "roughness", 0.5, 0.0, 1.0, "[0, 1]"));
  return material;
}

Material conductor(Element& element) {
  Material material{};
  material.reflectance = colour(element, "specular_reflectance", 1.0);
  const auto name = string_property(element, "material").value_or("none");
  const bool has_indices = has_property(element, "eta") || has_property(element, "k");
  if (name != "none") {
    if (has_indices)
      refuse(where_is(element, "material"), "\"material\" of " + describe(element) + " excludes \"eta\" and \"k\"");
    const auto* preset = find_conductor(name);
    if (!preset) {
      std::string list = "none";
      for (const auto& known : conductors()) list += ", " + std::string(known.name);
      refuse(where_is(element, "material"),
             "material=\"" + name + "\" of " + describe(element) + " is not known (known: " + list + ")");
    }
    material.kind = MATERIAL_CONDUCTOR;
    material.conductor_eta = packed(preset->eta);
    material.conductor_k = packed(preset->k);
    return material;
  }
  if (!has_indices) {
    material.kind = MATERIAL_MIRROR;
    return material;
  }
  material.kind = MATERIAL_CONDUCTOR;
  material.conductor_eta = packed(index_property(element, "eta", 0.0));
  material.conductor_k = packed(index_property(element, "k", 1.0));
  return material;
}

// A number, or a name of the table.
double refractive_index(Element& element, const std::string& name, const std::string& missing) {
  const auto* property = find_property(element, name);
  if (property && property->tag != "string") {
    if (property->tag != "float" && property->tag != "integer")
      refuse(property->where,
             "\"" + name + "\" of " + describe(element) + " is a <" + property->tag + ">, <float> or <string> is expected");
    const double value = number_property(element, name, 1.0);
    if (!(value > 0.0 && value <= MAX_INDEX))
      refuse(property->where, "\"" + name + "\" of " + describe(element) + " lies outside (0, 1e6]");
    return value;
  }
  const auto medium = string_property(element, name).value_or(missing);
  const auto value = find_refractive_index(medium);
  if (!value)
    refuse(where_is(element, name),
           name + "=\"" + medium + "\" of " + describe(element) + " is not known (known: " + refractive_index_names() + ")");
  return *value;
}

// Smooth or thin: what is named alike is alike.
Material dielectric(Element& element, MaterialKind kind) {
  Material material{};
  material.kind = kind;
  material.reflectance = colour(element, "specular_reflectance", 1.0);
  material.transmittance = colour(element, "specular_transmittance", 1.0);
  const double eta = refractive_index(element, "int_ior", "bk7") / refractive_index(element, "ext_ior", "air");
  if (!(eta >= 1.0 / MAX_INDEX && eta <= MAX_INDEX))
    refuse(where_is(element, "ext_ior"),
           "\"int_ior\" over \"ext_ior\" of " + describe(element) + " lies outside [1e-6, 1e6]");
  material.eta = static_cast<float>(eta);
  return material;
}

bool lets_light_through(const Material& material) {
  return material.kind == MATERIAL_DIELECTRIC || material.kind == MATERIAL_THIN_DIELECTRIC;
}

SurfaceMaterials twosided(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  const auto& element = document.elements[index];
  if (element.children.empty() || element.children.size() > 2)
    refuse(element.where, describe(element) + " holds " + std::to_string(element.children.size()) +
                              " objects, one or two <bsdf> are expected");
  SurfaceMaterials sides[2];
  for (std::size_t i = 0; i < element.children.size(); ++i) {
    const auto& child = element.children[i];
    if (document.elements[child.element].tag != "bsdf")
      refuse(child.where, describe(document.elements[child.element]) + " is not supported in " + describe(element) +
                              " (supported: bsdf)");
    sides[i] = read_bsdf(document, child.element, known, world);
    if (lets_light_through(world.materials[sides[i].front]))
      refuse(child.where, describe(document.elements[child.element]) + " lets light through and cannot be nested in " +
                              describe(element));
  }
  return {sides[0].front, sides[element.children.size() - 1].front};
}

}  // namespace

SurfaceMaterials read_bsdf(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  if (const auto found = known.find(index); found != known.end()) return found->second;
  auto& element = document.elements[index];
  SurfaceMaterials result;
  if (element.type == "twosided") {
    result = twosided(document, index, known, world);
  } else {
    Material material;
    if (element.type == "diffuse")
      material = diffuse(element);
    else if (element.type == "conductor")
      material = conductor(element);
    else if (element.type == "dielectric")
      material = dielectric(element, MATERIAL_DIELECTRIC);
    else if (element.type == "thindielectric")
      material = dielectric(element, MATERIAL_THIN_DIELECTRIC);
    else if (element.type == "roughdiffuse")
      material = rough_diffuse(element);
    else if (element.type == "principled")
      material = principled(element);
    else
      refuse(element.where, describe(element) +
                                " is not supported (supported: conductor, dielectric, diffuse, principled, roughdiffuse, "
                                "thindielectric, twosided)");
    refuse_children(element);
    result.front = static_cast<uint>(world.materials.size());
    if (lets_light_through(material)) result.back = result.front;
    world.materials.push_back(material);
  }
  known[index] = result;
  return result;
}

SurfaceMaterials add_diffuse(World& world, double reflectance) {
  Material material{};
  material.kind = MATERIAL_DIFFUSE;
  material.reflectance = packed(glm::dvec3(reflectance));
  world.materials.push_back(material);
  return {static_cast<uint>(world.materials.size() - 1), NONE};
}

}  // namespace oclair
