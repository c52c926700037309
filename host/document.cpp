#include "document.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_access.hpp>
#include <map>
#include <pugixml.hpp>
#include <set>

#include "error.h"
#include "number.h"
#include "substitution.h"
#include "transform.h"

namespace oclair {

namespace fs = std::filesystem;

namespace {

// Bounds on what a file can make us do. Real scenes stay far below each of them.
constexpr int MAX_DEPTH = 64;
constexpr std::size_t MAX_INCLUDES = 1000;
constexpr std::size_t MAX_TEXT = std::size_t{1} << 28;  // bytes of XML, all files together
constexpr std::size_t MAX_PROPERTIES = 100;             // of one element: they are searched one by one

const std::set<std::string> OBJECT_TAGS = {"bsdf", "emitter", "film", "integrator", "rfilter", "sampler", "sensor", "shape"};

// One XML file while it is read.
struct Source {
  std::string name;  // as messages show it
  fs::path file;
  std::vector<std::size_t> lines;  // offsets of the newlines
  std::vector<fs::path> search_path;
};

struct Parser {
  Document document;
  Substitution substitution;
  std::map<std::string, std::uint32_t> ids;
  std::vector<fs::path> open_files;  // the chain of includes, canonical
  std::size_t text_bytes = 0;
};

std::string where(const Source& source, std::ptrdiff_t offset) {
  const auto line = std::lower_bound(source.lines.begin(), source.lines.end(),
                                     static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
  return source.name + ":" + std::to_string(line - source.lines.begin() + 1);
}

std::string where(const Source& source, pugi::xml_node node) { return where(source, node.offset_debug()); }

std::string in_brackets(pugi::xml_node node) { return std::string("<") + node.name() + ">"; }

// Refuses attributes that are not listed and the absence of those marked with '!'.
void check_attributes(const Source& source, pugi::xml_node node, std::initializer_list<const char*> allowed) {
  std::string list;
  for (const char* name : allowed) list += (list.empty() ? "" : ", ") + std::string(name + (*name == '!'));
  std::set<std::string> seen;
  for (const auto attribute : node.attributes()) {
    if (std::none_of(allowed.begin(), allowed.end(),
                     [&](const char* name) { return std::string(name + (*name == '!')) == attribute.name(); }))
      refuse(where(source, node), "attribute \"" + std::string(attribute.name()) + "\" of " + in_brackets(node) +
                                      " is not supported (supported: " + list + ")");
    if (!seen.insert(attribute.name()).second)
      refuse(where(source, node),
             "attribute \"" + std::string(attribute.name()) + "\" of " + in_brackets(node) + " is given twice");
  }
  for (const char* name : allowed)
    if (*name == '!' && !node.attribute(name + 1))
      refuse(where(source, node), in_brackets(node) + " lacks the attribute \"" + (name + 1) + "\"");
}

void refuse_children(const Source& source, pugi::xml_node node) {
  for (const auto child : node.children())
    if (child.type() != pugi::node_comment && child.type() != pugi::node_pi)
      refuse(where(source, child), "nothing may be nested in " + in_brackets(node));
}

double number_of(const Source& source, pugi::xml_node node, std::string_view text) {
  const auto number = parse_number(text);
  if (!number) refuse(where(source, node), in_brackets(node) + ": \"" + std::string(text) + "\" is not a finite number");
  return *number;
}

// A list of exactly that many numbers.
std::vector<double> numbers_of(const Source& source, pugi::xml_node node, const char* attribute,
                               std::initializer_list<std::size_t> counts) {
  const auto parts = split_list(node.attribute(attribute).value());
  if (std::find(counts.begin(), counts.end(), parts.size()) == counts.end()) {
    std::string expected;
    for (const auto count : counts) expected += (expected.empty() ? "" : " or ") + std::to_string(count);
    refuse(where(source, node), in_brackets(node) + ": \"" + attribute + "\" holds " + std::to_string(parts.size()) +
                                    " numbers, " + expected + " are expected");
  }
  std::vector<double> numbers;
  for (const auto part : parts) numbers.push_back(number_of(source, node, part));
  return numbers;
}

// value="a b c" or value="a" or x, y, z; components that are not given become `missing`.
glm::dvec3 triple_of(const Source& source, pugi::xml_node node, double missing) {
  if (node.attribute("value")) {
    for (const char* axis : {"x", "y", "z"})
      if (node.attribute(axis))
        refuse(where(source, node), in_brackets(node) + ": \"value\" and \"" + axis + "\" exclude each other");
    const auto numbers = numbers_of(source, node, "value", {1, 3});
    return numbers.size() == 1 ? glm::dvec3(numbers[0]) : glm::dvec3(numbers[0], numbers[1], numbers[2]);
  }
  glm::dvec3 result(missing);
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    if (const auto attribute = node.attribute(axes[i])) result[i] = number_of(source, node, attribute.value());
  return result;
}

glm::dvec3 list_of_three(const Source& source, pugi::xml_node node, const char* attribute) {
  const auto numbers = numbers_of(source, node, attribute, {3});
  return {numbers[0], numbers[1], numbers[2]};
}

// The steps in the order of the file: the first acts first.
glm::dmat4 transform_of(Parser& parser, const Source& source, pugi::xml_node node) {
  glm::dmat4 result(1.0);
  for (const auto step : node.children()) {
    if (step.type() == pugi::node_comment || step.type() == pugi::node_pi) continue;
    const std::string at = where(source, step), name = step.name();
    substitute(parser.substitution, step, at);
    glm::dmat4 matrix(1.0);
    if (name == "translate") {
      check_attributes(source, step, {"x", "y", "z", "value"});
      matrix = translation(triple_of(source, step, 0.0));
    } else if (name == "scale") {
      check_attributes(source, step, {"x", "y", "z", "value"});
      matrix = scaling(triple_of(source, step, 1.0));
    } else if (name == "rotate") {
      check_attributes(source, step, {"!angle", "x", "y", "z", "value"});
      const auto axis = triple_of(source, step, 0.0);
      if (axis == glm::dvec3(0.0)) refuse(at, "<rotate>: the axis is zero");
      if (std::abs(glm::dot(axis, axis) - 1.0) > 1e-4)
        parser.document.warnings.push_back(
            at + ": <rotate>: the axis is not of unit length, so that this is not a rotation (Mitsuba takes it as it is)");
      matrix = rotation(axis, number_of(source, step, step.attribute("angle").value()));
    } else if (name == "lookat") {
      check_attributes(source, step, {"!origin", "!target", "up"});
      const auto up = *step.attribute("up").value() ? list_of_three(source, step, "up") : glm::dvec3(0.0);
      const auto frame = look_at(list_of_three(source, step, "origin"), list_of_three(source, step, "target"), up);
      if (!frame) refuse(at, "<lookat>: target is origin, or up is parallel to the line of sight");
      matrix = *frame;
    } else if (name == "matrix") {
      check_attributes(source, step, {"!value"});
      const auto numbers = numbers_of(source, step, "value", {9, 16});
      const int size = numbers.size() == 16 ? 4 : 3;
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) matrix[column][row] = numbers[row * size + column];
      if (glm::row(matrix, 3) != glm::dvec4(0.0, 0.0, 0.0, 1.0)) refuse(at, "<matrix>: the last row is not 0 0 0 1");
    } else {
      refuse(at, in_brackets(step) + " is not supported (supported: lookat, matrix, rotate, scale, translate)");
    }
    refuse_children(source, step);
    result = matrix * result;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        if (!std::isfinite(result[column][row])) refuse(at, in_brackets(step) + ": the transform overflows");
  }
  return result;
}

Value value_of(Parser& parser, const Source& source, pugi::xml_node node) {
  const std::string tag = node.name(), at = where(source, node);
  if (tag == "transform") {
    check_attributes(source, node, {"!name"});
    return transform_of(parser, source, node);
  }
  refuse_children(source, node);
  if (tag == "point" || tag == "vector") {
    check_attributes(source, node, {"!name", "x", "y", "z", "value"});
    for (const char* axis : {"x", "y", "z"})
      if (!node.attribute("value") && !node.attribute(axis))
        refuse(at, in_brackets(node) + " lacks the attribute \"" + axis + "\"");
    return triple_of(source, node, 0.0);
  }
  if (tag == "spectrum" && node.attribute("filename"))
    refuse(at, "<spectrum>: a file is not supported (supported: one constant value)");
  check_attributes(source, node, {"!name", "!value"});
  const std::string text = node.attribute("value").value();
  if (tag == "rgb") return triple_of(source, node, 0.0);
  if (tag == "float") return number_of(source, node, text);
  if (tag == "string") return text;
  if (tag == "spectrum") {
    if (text.find(':') != std::string::npos)
      refuse(at, "<spectrum>: a list of wavelengths is not supported (supported: one constant value)");
    return number_of(source, node, text);
  }
  if (tag == "integer") {
    const auto number = parse_integer(text);
    if (!number) refuse(at, "<integer>: \"" + text + "\" is not an integer of 64 bits");
    return *number;
  }
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower != "true" && lower != "false") refuse(at, "<boolean>: \"" + text + "\" is neither true nor false");
  return lower == "true";
}

std::uint32_t read_object(Parser& parser, Source& source, pugi::xml_node node, int depth);
std::uint32_t read_file(Parser& parser, const fs::path& file, const std::string& included_at,
                        std::vector<fs::path> search_path, int depth);

void read_include(Parser& parser, Source& source, pugi::xml_node node, std::uint32_t parent, int depth) {
  const std::string at = where(source, node), name = node.attribute("filename").value();
  check_attributes(source, node, {"!filename", "name"});
  refuse_children(source, node);
  const fs::path file = find_file(source.search_path, name);
  if (file.empty()) refuse(at, "<include>: no file \"" + name + "\" beside the scene or on its search path");
  const std::uint32_t root = read_file(parser, file, at, source.search_path, depth);
  auto& elements = parser.document.elements;
  if (elements[root].tag != "scene") {
    elements[parent].children.push_back({node.attribute("name").value(), at, "", root});
    return;
  }
  // An included scene stands for its contents; its own element stays empty, but for values that nothing will ask for.
  auto children = std::move(elements[root].children);
  elements[root].children.clear();
  elements[parent].children.insert(elements[parent].children.end(), children.begin(), children.end());
}

void read_alias(Parser& parser, const Source& source, pugi::xml_node node) {
  check_attributes(source, node, {"!id", "!as"});
  refuse_children(source, node);
  const std::string from = node.attribute("id").value(), to = node.attribute("as").value();
  const auto found = parser.ids.find(from);
  if (found == parser.ids.end())
    refuse(where(source, node), "<alias>: nothing before this line has the id \"" + from + "\"");
  if (!parser.ids.emplace(to, found->second).second) refuse(where(source, node), "<alias>: the id \"" + to + "\" is taken");
}

void read_search_path(Source& source, pugi::xml_node node, bool in_root) {
  check_attributes(source, node, {"!value"});
  refuse_children(source, node);
  if (!in_root) refuse(where(source, node), "<path> belongs directly into the root of its file");
  const std::string name = node.attribute("value").value();
  const fs::path directory = find_file(source.search_path, name);
  std::error_code error;
  if (directory.empty() || !fs::is_directory(directory, error))
    refuse(where(source, node), "<path>: there is no directory \"" + name + "\"");
  source.search_path.insert(source.search_path.begin(), directory);
}

// What stands inside an object: values, objects, and the elements that are instructions to this reader.
void read_content(Parser& parser, Source& source, pugi::xml_node node, std::uint32_t parent, int depth) {
  auto& elements = parser.document.elements;
  static const std::set<std::string> VALUE_TAGS = {"boolean",  "float",  "integer",   "point", "rgb",
                                                   "spectrum", "string", "transform", "vector"};
  for (const auto child : node.children()) {
    if (child.type() == pugi::node_comment || child.type() == pugi::node_pi) continue;
    const std::string at = where(source, child), tag = child.name();
    if (child.type() != pugi::node_element) refuse(at, "text inside " + in_brackets(node) + " means nothing");
    substitute(parser.substitution, child, at);
    const std::string name = child.attribute("name").value();
    if (OBJECT_TAGS.count(tag)) {
      const std::uint32_t element = read_object(parser, source, child, depth + 1);
      elements[parent].children.push_back({name, at, "", element});
    } else if (tag == "spectrum" && child.attribute("type")) {
      refuse(at, "<spectrum type=\"" + std::string(child.attribute("type").value()) +
                     "\"> is not supported (supported: one constant value)");
    } else if (VALUE_TAGS.count(tag)) {
      auto value = value_of(parser, source, child);
      auto& properties = elements[parent].properties;
      if (std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.name == name; }))
        refuse(at, "\"" + name + "\" is given twice");
      if (properties.size() == MAX_PROPERTIES)
        refuse(at, in_brackets(node) + " has more than " + std::to_string(MAX_PROPERTIES) + " parameters");
      properties.push_back({tag, name, at, std::move(value)});
    } else if (tag == "ref") {
      check_attributes(source, child, {"!id", "name"});
      refuse_children(source, child);
      elements[parent].children.push_back({name, at, child.attribute("id").value(), 0});
      if (elements[parent].children.back().ref.empty()) refuse(at, "<ref>: the id is empty");
    } else if (tag == "include") {
      read_include(parser, source, child, parent, depth + 1);
    } else if (tag == "alias") {
      read_alias(parser, source, child);
    } else if (tag == "path") {
      read_search_path(source, child, node.parent().type() == pugi::node_document);
    } else if (tag == "default") {
      check_attributes(source, child, {"!name", "!value"});
      refuse_children(source, child);
      add_default(parser.substitution, name, child.attribute("value").value(), at);
    } else {
      const char* type = child.attribute("type").value();
      refuse(at, (*type ? "<" + tag + " type=\"" + type + "\">" : in_brackets(child)) +
                     " is not supported (supported: alias, boolean, bsdf, default, emitter, film, float, include, integer, "
                     "integrator, path, point, "
                     "ref, rfilter, rgb, sampler, sensor, shape, spectrum, string, transform, vector)");
    }
  }
}

std::uint32_t read_object(Parser& parser, Source& source, pugi::xml_node node, int depth) {
  const std::string at = where(source, node), tag = node.name();
  if (depth > MAX_DEPTH) refuse(at, "elements are nested more than " + std::to_string(MAX_DEPTH) + " deep");
  const bool is_root = node.parent().type() == pugi::node_document;
  if (tag == "scene")
    check_attributes(source, node, {"!version", "type", "id", "name"});
  else if (is_root)
    check_attributes(source, node, {"!version", "!type", "id", "name"});
  else
    check_attributes(source, node, {"!type", "id", "name"});
  const auto index = static_cast<std::uint32_t>(parser.document.elements.size());
  Element element{tag, tag == "scene" ? "scene" : node.attribute("type").value(), node.attribute("id").value(), at, {}, {}};
  if (!element.id.empty()) {
    const auto [other, is_new] = parser.ids.emplace(element.id, index);
    if (!is_new)
      refuse(at, "the id \"" + element.id + "\" is taken by " + describe(parser.document.elements[other->second]) + " at " +
                     parser.document.elements[other->second].where);
  }
  parser.document.elements.push_back(std::move(element));
  read_content(parser, source, node, index, depth);
  return index;
}

void check_version(const Source& source, pugi::xml_node root) {
  if (!root.attribute("version")) refuse(where(source, root), in_brackets(root) + " lacks the attribute \"version\"");
  const std::string version = root.attribute("version").value();
  const bool numeric = !version.empty() && version.find_first_not_of("0123456789.") == std::string::npos;
  if (!numeric || (version[0] != '2' && version[0] != '3') || (version.size() > 1 && version[1] != '.'))
    refuse(where(source, root),
           "version \"" + version + "\" of the scene format is not supported (supported: 2.x.x, 3.x.x)");
}

std::string read_text(Parser& parser, const fs::path& file, const std::string& included_at) {
  std::error_code error;
  const std::string prefix = included_at.empty() ? "" : included_at + ": ";
  if (!fs::is_regular_file(file, error)) throw Error(Exit::scene, prefix + file.string() + ": there is no such file");
  std::ifstream stream(file, std::ios::binary);
  const auto size = fs::file_size(file, error);
  if (!stream || error) throw Error(Exit::scene, prefix + file.string() + ": cannot be read");
  parser.text_bytes += size;
  if (size > MAX_TEXT || parser.text_bytes > MAX_TEXT)
    throw Error(Exit::scene, prefix + file.string() + ": the scene is longer than 256 MiB of XML");
  std::string text(size, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(size)))
    throw Error(Exit::scene, prefix + file.string() + ": cannot be read");
  return text;
}

std::uint32_t read_file(Parser& parser, const fs::path& file, const std::string& included_at,
                        std::vector<fs::path> search_path, int depth) {
  std::error_code error;
  const fs::path identity = fs::weakly_canonical(file, error);
  if (std::find(parser.open_files.begin(), parser.open_files.end(), identity) != parser.open_files.end())
    refuse(included_at, "<include>: \"" + file.string() + "\" includes itself");
  if (parser.document.files.size() > MAX_INCLUDES)
    refuse(included_at, "<include>: more than " + std::to_string(MAX_INCLUDES) + " files are included");
  parser.open_files.push_back(identity);
  parser.document.files.push_back(file.string());

  const std::string text = read_text(parser, file, included_at);
  Source source{file.string(), file, {}, std::move(search_path)};
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') source.lines.push_back(i);
  if (file.has_parent_path()) source.search_path.insert(source.search_path.begin(), file.parent_path());

  pugi::xml_document document;
  const auto result = document.load_buffer(text.data(), text.size());
  if (!result) refuse(where(source, result.offset), std::string("not well-formed XML: ") + result.description());
  const auto root = document.document_element();
  for (const auto node : document.children())
    if (node.type() == pugi::node_element && node != root)
      refuse(where(source, node), in_brackets(node) + " stands behind the end of the document");
  const std::string tag = root.name();
  if (tag != "scene" && (included_at.empty() || !OBJECT_TAGS.count(tag)))
    refuse(where(source, root), in_brackets(root) + (included_at.empty() ? " is not supported as root (supported: scene)"
                                                                         : " is not supported as root of an included file"));
  substitute(parser.substitution, root, where(source, root));
  check_version(source, root);
  const auto index = read_object(parser, source, root, depth);
  if (included_at.empty()) parser.document.search_path = source.search_path;
  parser.open_files.pop_back();
  return index;
}

// Height of the tree below an element through nested and referenced children; refuses cycles and depth.
int measure_height(const Document& document, std::uint32_t index, std::vector<int>& heights, int depth) {
  constexpr int IN_PROGRESS = -1;
  const auto& element = document.elements[index];
  heights[index] = IN_PROGRESS;
  int height = 0;
  for (const auto& child : element.children) {
    if (heights[child.element] == IN_PROGRESS)
      refuse(child.where, describe(document.elements[child.element]) + " contains itself");
    const int below = heights[child.element] > 0 ? heights[child.element]
                      : depth < MAX_DEPTH        ? measure_height(document, child.element, heights, depth + 1)
                                                 : MAX_DEPTH;
    height = std::max(height, below);
    if (height + depth > MAX_DEPTH)
      refuse(child.where, "elements are nested more than " + std::to_string(MAX_DEPTH) + " deep");
  }
  return heights[index] = height + 1;
}

void resolve_references(Parser& parser) {
  auto& elements = parser.document.elements;
  for (auto& element : elements)
    for (auto& child : element.children) {
      if (child.ref.empty()) continue;
      const auto found = parser.ids.find(child.ref);
      if (found == parser.ids.end()) refuse(child.where, "<ref>: nothing has the id \"" + child.ref + "\"");
      child.element = found->second;
    }
  std::vector<int> heights(elements.size(), 0);
  for (std::uint32_t i = 0; i < elements.size(); ++i)
    if (heights[i] == 0) measure_height(parser.document, i, heights, 0);
}

}  // namespace

void refuse(const std::string& where, const std::string& what) { throw Error(Exit::scene, where + ": " + what); }

std::string describe(const Element& element) {
  return element.tag == "scene" ? "<scene>" : "<" + element.tag + " type=\"" + element.type + "\">";
}

fs::path find_file(const std::vector<fs::path>& search_path, const std::string& name) {
  std::error_code error;
  if (name.empty() || name.find('\0') != std::string::npos) return {};
  if (fs::path(name).is_absolute()) return fs::exists(name, error) ? fs::path(name) : fs::path();
  for (const auto& directory : search_path)
    if (auto file = directory / name; fs::exists(file, error)) return file.lexically_normal();
  return {};
}

Document read_document(const fs::path& file, const Definitions& definitions) {
  Parser parser{{}, make_substitution(definitions), {}, {}, 0};
  read_file(parser, file, "", {fs::path(".")}, 0);
  resolve_references(parser);
  check_definitions(parser.substitution);
  return std::move(parser.document);
}

}  // namespace oclair
