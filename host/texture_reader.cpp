#include "texture_reader.h"

#include <new>

#include "property.h"
#include "texture_file.h"

namespace oclair {
namespace {

// Coordinates are transformed in the plane: of the matrix in space, the rows and columns of x and y and the translation count.
glm::dmat3 to_uv_of(Element& element) {
  const auto m = transform_property(element, "to_uv").value_or(glm::dmat4(1.0));
  return glm::dmat3(m[0][0], m[0][1], 0.0, m[1][0], m[1][1], 0.0, m[3][0], m[3][1], 1.0);
}

void read_bitmap(Document& document, std::uint32_t index, KnownTextures& known, World& world, WorldTexture& texture) {
  texture.image = image_property(document, index, known, world);
  auto& element = document.elements[index];
  texture.kind = TEXTURE_BITMAP;
  texture.srgb = !boolean_property(element, "raw", false) && texture.image->srgb;
  texture.nearest = choice_property(element, "filter_type", "bilinear", {"bilinear", "nearest"}) == "nearest";
  const auto wrap = choice_property(element, "wrap_mode", "repeat", {"repeat", "mirror", "clamp"});
  texture.wrap = wrap == "repeat" ? WRAP_REPEAT : wrap == "mirror" ? WRAP_MIRROR : WRAP_CLAMP;
  texture.to_uv = to_uv_of(element);
  // How Mitsuba stores the texels and finds them; here they stay as they are in the file.
  choice_property(element, "format", "variant", {"variant", "auto", "fp16", "fp32"});
  boolean_property(element, "accel", true);
}

void read_mesh_attribute(Element& element, WorldTexture& texture) {
  const auto name = string_property(element, "name");
  if (!name) refuse(element.where, describe(element) + " lacks <string name=\"name\">");
  if (!name->starts_with("vertex_") && !name->starts_with("face_"))
    refuse(where_is(element, "name"),
           "name=\"" + *name + "\" of " + describe(element) + " begins neither with vertex_ nor with face_");
  if (number_property(element, "scale", 1.0) != 1.0)
    refuse(where_is(element, "scale"), "\"scale\" of " + describe(element) + " is not supported (supported: 1)");
  texture.attribute = *name;
}

}  // namespace

uint read_texture(Document& document, std::uint32_t index, KnownTextures& known, World& world) {
  if (const auto found = known.elements.find(index); found != known.elements.end()) return found->second;
  auto& element = document.elements[index];
  WorldTexture texture;
  texture.where = element.where;
  if (element.type == "bitmap") {
    read_bitmap(document, index, known, world, texture);
  } else if (element.type == "checkerboard") {
    texture.kind = TEXTURE_CHECKERBOARD;
    texture.color0 = reflectance_property(element, "color0", 0.4);
    texture.color1 = reflectance_property(element, "color1", 0.2);
    texture.to_uv = to_uv_of(element);
  } else if (element.type == "mesh_attribute") {
    read_mesh_attribute(element, texture);
  } else {
    refuse(element.where, describe(element) + " is not supported (supported: bitmap, checkerboard, mesh_attribute)");
  }
  refuse_unasked_children(document, element);
  world.textures.push_back(std::move(texture));
  return known.elements[index] = static_cast<uint>(world.textures.size());
}

uint texture_property(Document& document, std::uint32_t index, const std::string& name, KnownTextures& known, World& world) {
  auto& element = document.elements[index];
  uint result = 0;
  for (auto& child : element.children) {
    if (child.name != name || document.elements[child.element].tag != "texture") continue;
    if (result != 0 || has_property(element, name)) refuse(child.where, "\"" + name + "\" is given twice");
    child.asked = true;
    result = read_texture(document, child.element, known, world);
  }
  return result;
}

std::shared_ptr<const Image> image_property(Document& document, std::uint32_t index, KnownTextures& known, World& world) {
  auto& element = document.elements[index];
  const auto name = string_property(element, "filename");
  if (!name) refuse(element.where, describe(element) + " lacks <string name=\"filename\">");
  const std::string at = where_is(element, "filename");
  const auto file = find_file(document.search_path, *name).string();
  if (file.empty()) refuse(at, "no image file \"" + *name + "\" beside the scene or on its search path");
  auto& image = known.images[file];
  if (image) return image;
  try {
    image = std::make_shared<const Image>(parse_image(text_of(read_scene_file(file, *name, world.files))));
  } catch (const SceneFileError& error) {
    refuse(at, file + ": " + error.what());
  } catch (const std::bad_alloc&) {
    refuse(at, file + ": there is not enough memory for it");
  }
  return image;
}

}  // namespace oclair
