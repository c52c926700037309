#include "bsdf_reader.h"

#include <set>
#include <sstream>

#include "bsdf_wrapper.h"
#include "color.h"
#include "conductors.h"
#include "material.h"
#include "property.h"
#include "refractive_indices.h"

namespace oclair {

namespace {

constexpr double MAX_INDEX = 1e6;

// An element and where what it names is found.
struct Source {
  Document& document;
  std::uint32_t index;
  KnownTextures& textures;
  World& world;
  Element& element() const { return document.elements[index]; }
};

// A colour in [0, 1], or the texture that takes its place.
void read_reflectance(const Source& source, const std::string& name, double missing, packed_float3& constant, uint& texture) {
  texture = texture_property(source.document, source.index, name, source.textures, source.world);
  if (texture == 0) constant = pack(reflectance_property(source.element(), name, missing));
}

double number_between(Element& element, const std::string& name, double missing, double least, double greatest,
                      const char* range) {
  const double value = number_property(element, name, missing);
  if (!(value >= least && value <= greatest))
    refuse(where_is(element, name), "\"" + name + "\" of " + describe(element) + " lies outside " + range);
  return value;
}

// A number, or the texture that it becomes a factor of: `scale` times what the scene file says.
void read_roughness(const Source& source, const std::string& name, double missing, double most, const char* range, double scale,
                    Material& material) {
  material.roughness_texture = texture_property(source.document, source.index, name, source.textures, source.world);
  const double value = material.roughness_texture != 0 ? 1.0 : number_between(source.element(), name, missing, 0.0, most, range);
  material.roughness = static_cast<float>(scale * value);
}

Material diffuse(const Source& source) {
  Material material{};
  material.kind = MATERIAL_DIFFUSE;
  read_reflectance(source, "reflectance", 0.5, material.reflectance, material.reflectance_texture);
  return material;
}

// Mitsuba 0.6's: alpha is the roughness of a Beckmann distribution, sigma that of Oren and Nayar.
constexpr double SIGMA_OF_ALPHA = 0.70710678118654752;

Material rough_diffuse(const Source& source) {
  Material material{};
  material.kind = boolean_property(source.element(), "use_fast_approx", false) ? MATERIAL_OREN_NAYAR_FAST : MATERIAL_OREN_NAYAR;
  read_reflectance(source, "reflectance", 0.5, material.reflectance, material.reflectance_texture);
  read_roughness(source, "alpha", 0.2, 2.0, "[0, 2]", SIGMA_OF_ALPHA, material);
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
Material principled(const Source& source) {
  Element& element = source.element();
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
  read_reflectance(source, "base_color", 0.5, material.reflectance, material.reflectance_texture);
  read_roughness(source, "roughness", 0.5, 1.0, "[0, 1]", 1.0, material);
  return material;
}

Material conductor(const Source& source) {
  Element& element = source.element();
  Material material{};
  read_reflectance(source, "specular_reflectance", 1.0, material.reflectance, material.reflectance_texture);
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
    material.conductor_eta = pack(preset->eta);
    material.conductor_k = pack(preset->k);
    return material;
  }
  if (!has_indices) {
    material.kind = MATERIAL_MIRROR;
    return material;
  }
  material.kind = MATERIAL_CONDUCTOR;
  material.conductor_eta = pack(index_property(element, "eta", 0.0));
  material.conductor_k = pack(index_property(element, "k", 1.0));
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
Material dielectric(const Source& source, MaterialKind kind) {
  Element& element = source.element();
  Material material{};
  material.kind = kind;
  read_reflectance(source, "specular_reflectance", 1.0, material.reflectance, material.reflectance_texture);
  read_reflectance(source, "specular_transmittance", 1.0, material.transmittance, material.transmittance_texture);
  const double eta = refractive_index(element, "int_ior", "bk7") / refractive_index(element, "ext_ior", "air");
  if (!(eta >= 1.0 / MAX_INDEX && eta <= MAX_INDEX))
    refuse(where_is(element, "ext_ior"),
           "\"int_ior\" over \"ext_ior\" of " + describe(element) + " lies outside [1e-6, 1e6]");
  material.eta = static_cast<float>(eta);
  return material;
}

const std::map<std::string, Material (*)(const Source&)> READERS = {
    {"conductor", conductor},
    {"dielectric", [](const Source& source) { return dielectric(source, MATERIAL_DIELECTRIC); }},
    {"diffuse", diffuse},
    {"principled", principled},
    {"roughdiffuse", rough_diffuse},
    {"thindielectric", [](const Source& source) { return dielectric(source, MATERIAL_THIN_DIELECTRIC); }}};

std::string supported() {
  std::set<std::string> types = wrapper_types();
  for (const auto& reader : READERS) types.insert(reader.first);
  std::string list;
  for (const auto& type : types) list += (list.empty() ? "" : ", ") + type;
  return list;
}

}  // namespace

SurfaceMaterials read_bsdf(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  if (const auto found = known.elements.find(index); found != known.elements.end()) return found->second;
  auto& element = document.elements[index];
  SurfaceMaterials result;
  if (is_wrapper(element)) {
    result = read_wrapper(document, index, known, world);
  } else {
    const Source source{document, index, known.textures, world};
    const auto reader = READERS.find(element.type);
    if (reader == READERS.end()) refuse(element.where, describe(element) + " is not supported (supported: " + supported() + ")");
    const Material material = reader->second(source);
    refuse_unasked_children(document, element);
    result.front = static_cast<uint>(world.materials.size());
    if (lets_light_through(material)) result.back = result.front;
    world.materials.push_back(material);
  }
  known.elements[index] = result;
  return result;
}

SurfaceMaterials add_diffuse(World& world, double reflectance) {
  Material material{};
  material.kind = MATERIAL_DIFFUSE;
  material.reflectance = pack(glm::dvec3(reflectance));
  world.materials.push_back(material);
  return {static_cast<uint>(world.materials.size() - 1), NONE};
}

}  // namespace oclair
