#include "bsdf_wrapper.h"

#include <cmath>
#include <functional>

#include "material.h"
#include "property.h"

namespace oclair {

namespace {

constexpr double MAX_BUMP_SCALE = 1e30;  // what float32 holds with room for the arithmetic on it

// A copy of the material, and of all that a blend comes down to, with a change made to each; NONE of NONE.
class Copies {
 public:
  Copies(World& world, std::function<void(Material&)> change) : world_(world), change_(std::move(change)) {}

  uint operator()(uint index) {
    if (index == NONE) return NONE;
    if (const auto found = made_.find(index); found != made_.end()) return found->second;
    Material m = world_.materials[index];
    if (m.kind == MATERIAL_BLEND) {
      m.first = (*this)(m.first);
      m.second = (*this)(m.second);
    } else {
      change_(m);
    }
    world_.materials.push_back(m);
    return made_[index] = static_cast<uint>(world_.materials.size() - 1);
  }

 private:
  World& world_;
  std::function<void(Material&)> change_;
  std::map<uint, uint> made_;
};

// The BSDFs in an element that holds `count` of them; whatever else is in it must have been asked for.
std::vector<SurfaceMaterials> nested_bsdfs(Document& document, std::uint32_t index, std::size_t count, KnownBsdfs& known,
                                           World& world) {
  auto& element = document.elements[index];
  std::vector<SurfaceMaterials> nested;
  for (auto& child : element.children) {
    if (document.elements[child.element].tag != "bsdf") continue;
    child.asked = true;
    nested.push_back(read_bsdf(document, child.element, known, world));
  }
  refuse_unasked_children(document, element);
  if (nested.size() != count)
    refuse(element.where, describe(element) + " holds " + std::to_string(nested.size()) + " <bsdf>, " + std::to_string(count) +
                              (count == 1 ? " is expected" : " are expected"));
  return nested;
}

double share_property(Element& element, const std::string& name, double missing) {
  const double share = number_property(element, name, missing);
  if (!(share >= 0.0 && share <= 1.0))
    refuse(where_is(element, name), "\"" + name + "\" of " + describe(element) + " lies outside [0, 1]");
  return share;
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
    const auto transmits = [](const Material& m) {
      return lets_light_through(m) || has_opacity(m);
    };
    if (any_material(world.materials, sides[i].front, transmits))
      refuse(child.where, describe(document.elements[child.element]) + " lets light through and cannot be nested in " +
                              describe(element));
  }
  return {sides[0].front, sides[element.children.size() - 1].front};
}

// Where the nested one absorbs, the back of it, so does what is left of the mask.
SurfaceMaterials mask(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  auto& element = document.elements[index];
  const uint texture = texture_property(document, index, "opacity", known.textures, world);
  const float transparency = texture != 0 ? 0.0f : static_cast<float>(1.0 - share_property(element, "opacity", 0.5));
  SurfaceMaterials nested = nested_bsdfs(document, index, 1, known, world)[0];
  if (any_material(world.materials, nested.front, has_opacity) || any_material(world.materials, nested.back, has_opacity))
    refuse(element.where, describe(element) + " around another one is not supported");
  if (nested.back == NONE) nested.back = add_diffuse(world, 0.0).front;
  Copies copy(world, [&](Material& m) {
    m.transparency = transparency;
    m.opacity_texture = texture;
  });
  return {copy(nested.front), copy(nested.back)};
}

// Mitsuba's shadowing function (Estevez, Lecocq, Stellmach 2019) is not there: only its absence can be asked for.
void accept_no_shadowing(Element& element) {
  const auto* property = find_property(element, "use_shadowing_function");
  if (property && property->value == Value(false)) boolean_property(element, "use_shadowing_function", false);
}

// A texture of normals or heights: interpolated texels, as in Mitsuba.
void require_bitmap(const Element& element, const Element& texture) {
  if (texture.type != "bitmap")
    refuse(texture.where, describe(texture) + " is not supported in " + describe(element) + " (supported: bitmap)");
}

SurfaceMaterials normalmap(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  auto& element = document.elements[index];
  const uint texture = texture_property(document, index, "normalmap", known.textures, world);
  if (texture == 0) refuse(element.where, describe(element) + " lacks <texture name=\"normalmap\">");
  for (const auto& child : element.children)
    if (child.name == "normalmap") require_bitmap(element, document.elements[child.element]);
  const WorldTexture& source = world.textures[texture - 1];
  if (source.image->channels != 3)
    refuse(source.where, "\"normalmap\" of " + describe(element) + " has one channel, three are expected");
  if (source.srgb)
    refuse(source.where, "\"normalmap\" of " + describe(element) +
                             " would be decoded as sRGB, which is not supported (supported: \"raw\" true)");
  accept_no_shadowing(element);
  const SurfaceMaterials nested = nested_bsdfs(document, index, 1, known, world)[0];
  const auto change = [&](uint turned) {
    return Copies(world, [&, turned](Material& m) {
      if (m.normal_texture != 0) refuse(element.where, describe(element) + " around another one is not supported");
      m.normal_texture = texture;
      m.normal_turned = turned;
    });
  };
  // The back of the surface that the map describes, where the kernel would mirror it.
  return {change(0)(nested.front), change(1)(nested.back)};
}

SurfaceMaterials bumpmap(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  auto& element = document.elements[index];
  uint texture = 0;
  for (auto& child : element.children) {
    const auto& nested = document.elements[child.element];
    if (nested.tag != "texture") continue;
    if (texture != 0) refuse(child.where, describe(element) + " has more than one <texture>");
    require_bitmap(element, nested);
    child.asked = true;
    texture = read_texture(document, child.element, known.textures, world);
  }
  if (texture == 0) refuse(element.where, describe(element) + " has no <texture>");
  const double scale = number_property(element, "scale", 1.0);
  if (!(std::abs(scale) <= MAX_BUMP_SCALE))
    refuse(where_is(element, "scale"), "\"scale\" of " + describe(element) + " lies outside [-1e30, 1e30]");
  accept_no_shadowing(element);
  const SurfaceMaterials nested = nested_bsdfs(document, index, 1, known, world)[0];
  const auto change = [&](double side) {
    return Copies(world, [&, side](Material& m) {
      if (m.bump_texture != 0) refuse(element.where, describe(element) + " around another one is not supported");
      m.bump_texture = texture;
      m.bump_scale = static_cast<float>(side * scale);
    });
  };
  // From behind a bump is a dent, where the kernel would mirror it.
  return {change(1.0)(nested.front), change(-1.0)(nested.back)};
}

SurfaceMaterials blend(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  auto& element = document.elements[index];
  Material m{};
  m.kind = MATERIAL_BLEND;
  m.weight_texture = texture_property(document, index, "weight", known.textures, world);
  if (m.weight_texture == 0) {
    if (!has_property(element, "weight")) refuse(element.where, describe(element) + " lacks <float name=\"weight\">");
    m.weight = static_cast<float>(share_property(element, "weight", 0.5));
  }
  const auto nested = nested_bsdfs(document, index, 2, known, world);
  const auto join = [&](uint first, uint second) {
    if (first == NONE && second == NONE) return NONE;
    m.first = first != NONE ? first : add_diffuse(world, 0.0).front;
    m.second = second != NONE ? second : add_diffuse(world, 0.0).front;
    world.materials.push_back(m);
    return static_cast<uint>(world.materials.size() - 1);
  };
  SurfaceMaterials result;
  result.front = join(nested[0].front, nested[1].front);
  result.back = join(nested[0].back, nested[1].back);
  return result;
}

using Reader = SurfaceMaterials (*)(Document&, std::uint32_t, KnownBsdfs&, World&);

const std::map<std::string, Reader> READERS = {
    {"blendbsdf", blend}, {"bumpmap", bumpmap}, {"mask", mask}, {"normalmap", normalmap}, {"twosided", twosided}};

}  // namespace

bool is_wrapper(const Element& element) { return READERS.contains(element.type); }

std::set<std::string> wrapper_types() {
  std::set<std::string> types;
  for (const auto& reader : READERS) types.insert(reader.first);
  return types;
}

SurfaceMaterials read_wrapper(Document& document, std::uint32_t index, KnownBsdfs& known, World& world) {
  return READERS.at(document.elements[index].type)(document, index, known, world);
}

}  // namespace oclair
