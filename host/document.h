// A scene file as a tree of elements: XML read, <include>, <default>, <alias> and <ref> resolved, values converted to
// their types, but nothing yet known about what a type means. Every element and value remembers its file and line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <variant>
#include <vector>

#include "reader.h"
#include "scene_file.h"

namespace oclair {

// integer | float, spectrum | boolean | string | rgb, point, vector | transform: told apart by Property::tag.
using Value = std::variant<std::int64_t, double, bool, std::string, glm::dvec3, glm::dmat4>;

struct Property {
  std::string tag;  // "float", "rgb", "transform", ...
  std::string name;
  std::string where;  // "file:line"
  Value value;        // every number in it is finite
  bool asked = false;
};

// An object inside another one: nested, or named by <ref>.
struct Child {
  std::string name;   // the name attribute; empty without one
  std::string where;  // of the <ref>, or of the nested element
  std::string ref;    // id that a <ref> names; empty if nested
  std::uint32_t element = 0;
  bool asked = false;
};

struct Element {
  std::string tag;   // "bsdf", "shape", ...
  std::string type;  // "diffuse", ...; "scene" for a scene
  std::string id;
  std::string where;
  std::vector<Property> properties;  // names are unique
  std::vector<Child> children;       // nested and referenced, in the order of the file
};

struct Document {
  std::vector<Element> elements;                   // the first is the scene; children have no cycles, depth <= 64
  std::vector<std::filesystem::path> search_path;  // where files named by the scene are looked for, first match wins
  std::vector<SceneFile> files;                    // every XML file that was read, the scene first
  std::vector<std::string> warnings;               // "file:line: ..."
};

// Throws Error(Exit::scene) for a file that is missing, not well-formed or breaks a rule of the format that holds for all
// elements; Error(Exit::usage) for a definition that the scene does not use.
Document read_document(const std::filesystem::path& file, const Definitions& definitions);

// First existing file of that name along the search path, or the empty path. An absolute name stands for itself.
std::filesystem::path find_file(const std::vector<std::filesystem::path>& search_path, const std::string& name);

// Throws Error(Exit::scene) with the line "where: what".
[[noreturn]] void refuse(const std::string& where, const std::string& what);

// <bsdf type="diffuse">, for messages.
std::string describe(const Element& element);

}  // namespace oclair
