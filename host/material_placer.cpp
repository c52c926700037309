#include "material_placer.h"

#include <algorithm>

#include "color.h"
#include "error.h"
#include "material.h"

namespace oclair {
namespace {

// The one list of what a material's textures are.
constexpr uint Material::*TEXTURES[] = {&Material::reflectance_texture, &Material::transmittance_texture,
                                        &Material::roughness_texture,   &Material::opacity_texture,
                                        &Material::normal_texture,      &Material::bump_texture,
                                        &Material::weight_texture};

}  // namespace

void MaterialPlacer::begin_shape(const WorldShape& shape, std::span<const uint> faces) {
  shape_ = &shape;
  faces_ = faces;
  shape_materials_.clear();
  shape_textures_.clear();
}

bool MaterialPlacer::is_attribute(uint reference) const {
  return reference != 0 && !world_.textures[reference - 1].attribute.empty();
}

bool MaterialPlacer::texture_needs_uv(uint reference) const { return reference != 0 && !is_attribute(reference); }

bool MaterialPlacer::any_texture(uint index, bool (MaterialPlacer::*holds)(uint) const) const {
  return any_material(world_.materials, index, [&](const Material& m) {
    return std::any_of(std::begin(TEXTURES), std::end(TEXTURES), [&](auto texture) { return (this->*holds)(m.*texture); });
  });
}

bool MaterialPlacer::uses_attributes(uint index) const { return any_texture(index, &MaterialPlacer::is_attribute); }

bool MaterialPlacer::needs_uv(uint index) const { return any_texture(index, &MaterialPlacer::texture_needs_uv); }

uint MaterialPlacer::material(uint index) {
  if (index == NONE) return NONE;
  auto& known = uses_attributes(index) ? shape_materials_ : materials_;
  if (const auto found = known.find(index); found != known.end()) return found->second;
  Material m = world_.materials[index];
  for (const auto texture_of : TEXTURES) m.*texture_of = texture(m.*texture_of);
  if (m.kind == MATERIAL_BLEND) {
    m.first = material(m.first);
    m.second = material(m.second);
  }
  m.bump_scale = static_cast<float>(scene_.frame.place_length(m.bump_scale));
  const uint placed = static_cast<uint>(scene_.materials.size());
  scene_.materials.push_back(m);
  known[index] = placed;
  return placed;
}

ulong MaterialPlacer::append(std::span<const std::byte> bytes) {
  scene_.texels.resize((scene_.texels.size() + 3) / 4 * 4);
  const ulong offset = scene_.texels.size();
  scene_.texels.insert(scene_.texels.end(), bytes.begin(), bytes.end());
  return offset;
}

uint MaterialPlacer::image(const Image& image, bool srgb) {
  const auto found = images_.find(&image);
  const ulong offset = found != images_.end() ? found->second : images_[&image] = append(image.texels);
  Texture t{};
  t.kind = TEXTURE_BITMAP;
  t.channels = image.channels;
  t.to_u = {1.0f, 0.0f, 0.0f};
  t.to_v = {0.0f, 1.0f, 0.0f};
  t.format = image.format;
  t.srgb = srgb;
  t.offset = offset;
  t.width = image.width;
  t.height = image.height;
  if (srgb && image.format == TEXEL_U8 && scene_.srgb.empty()) scene_.srgb = srgb_table();
  scene_.textures.push_back(t);
  return static_cast<uint>(scene_.textures.size());
}

Texture MaterialPlacer::attribute(const WorldTexture& source) {
  const auto& attributes = shape_->mesh.attributes;
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const MeshAttribute& a) { return a.name == source.attribute; });
  if (found == attributes.end()) {
    std::string names;
    for (const MeshAttribute& a : attributes) names += (names.empty() ? "" : ", ") + a.name;
    throw Error(Exit::scene, source.where + ": the shape at " + shape_->where + " has no attribute \"" + source.attribute +
                                 "\" (it has: " + (names.empty() ? "none" : names) + ")");
  }
  if (found->values.empty())
    throw Error(Exit::scene, source.where + ": the attribute \"" + source.attribute + "\" of the shape at " + shape_->where +
                                 " is of integers, expected floating-point numbers");
  Texture t{};
  t.kind = found->per_face ? TEXTURE_FACE_ATTRIBUTE : TEXTURE_VERTEX_ATTRIBUTE;
  t.channels = found->channels;
  t.format = TEXEL_FLOAT;
  std::vector<float> values;
  if (found->per_face) {
    for (const uint face : faces_)
      for (uint c = 0; c < t.channels; ++c) values.push_back(found->values[std::size_t{face} * t.channels + c]);
  } else {
    values = found->values;
  }
  t.offset = append(std::as_bytes(std::span(values)));
  return t;
}

uint MaterialPlacer::texture(uint reference) {
  if (reference == 0) return 0;
  auto& known = is_attribute(reference) ? shape_textures_ : textures_;
  if (const auto found = known.find(reference); found != known.end()) return found->second;
  const WorldTexture& source = world_.textures[reference - 1];
  if (is_attribute(reference)) {
    scene_.textures.push_back(attribute(source));
  } else if (source.kind == TEXTURE_BITMAP) {
    image(*source.image, source.srgb);
  } else {
    scene_.textures.emplace_back();
    scene_.textures.back().channels = 3;
  }
  Texture& t = scene_.textures.back();
  if (!is_attribute(reference)) {
    t.kind = source.kind;
    t.to_u = pack({source.to_uv[0][0], source.to_uv[1][0], source.to_uv[2][0]});
    t.to_v = pack({source.to_uv[0][1], source.to_uv[1][1], source.to_uv[2][1]});
    t.wrap = source.wrap;
    t.nearest = source.nearest;
    t.color0 = pack(source.color0);
    t.color1 = pack(source.color1);
  }
  return known[reference] = static_cast<uint>(scene_.textures.size());
}

std::vector<float> srgb_table() {
  std::vector<float> table(256);
  for (int i = 0; i < 256; ++i) table[i] = static_cast<float>(srgb_decoded(i / 255.0));
  return table;
}

}  // namespace oclair
