#include "document.h"

#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <set>

#include "error.h"
#include "substitution.h"
#include "value.h"
#include "xml_source.h"

namespace oclair {

namespace fs = std::filesystem;

namespace {

// Bounds on what a file can make us do. Real scenes stay far below each of them.
constexpr int MAX_DEPTH = 64;
constexpr std::size_t MAX_INCLUDES = 1000;
constexpr std::size_t MAX_TEXT = std::size_t{1} << 28;  // bytes of XML, all files together
constexpr std::size_t MAX_PROPERTIES = 100;             // of one element: they are searched one by one
constexpr std::size_t MAX_SEARCH_PATH = 100;            // directories, likewise, for each file that is named

const std::set<std::string> OBJECT_TAGS = {"bsdf",    "emitter", "film",  "integrator", "rfilter",
                                           "sampler", "sensor",  "shape", "texture"};

struct Parser {
  Document document;
  Substitution substitution;
  std::map<std::string, std::uint32_t> ids;
  std::vector<fs::path> open_files;  // the chain of includes, canonical
  std::size_t files = 0;             // that were read, however often
  std::size_t text_bytes = 0;
};

std::uint32_t read_object(Parser& parser, Source& source, pugi::xml_node node, int depth);
std::uint32_t read_file(Parser& parser, const fs::path& file, const std::string& name, const std::string& included_at,
                        std::vector<fs::path> search_path, int depth);

void read_include(Parser& parser, Source& source, pugi::xml_node node, std::uint32_t parent, int depth) {
  const std::string at = where(source, node), name = node.attribute("filename").value();
  check_attributes(source, node, {"!filename", "name"});
  refuse_children(source, node);
  const fs::path file = find_file(source.search_path, name);
  if (file.empty()) refuse(at, "<include>: no file \"" + name + "\" beside the scene or on its search path");
  const std::uint32_t root = read_file(parser, file, name, at, source.search_path, depth);
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
  if (source.search_path.size() >= MAX_SEARCH_PATH)
    refuse(where(source, node), "<path>: more than " + std::to_string(MAX_SEARCH_PATH) + " directories are on the search path");
  source.search_path.insert(source.search_path.begin(), directory);
}

// What stands inside an object: values, objects, and the elements that are instructions to this reader.
void read_content(Parser& parser, Source& source, pugi::xml_node node, std::uint32_t parent, int depth) {
  auto& elements = parser.document.elements;
  for (const auto child : node.children()) {
    if (says_nothing(child)) continue;
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
    } else if (is_value_tag(tag)) {
      auto value = read_value(source, child, parser.substitution, parser.document.warnings);
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
                     "ref, rfilter, rgb, sampler, sensor, shape, spectrum, string, texture, transform, vector)");
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

BufferVector<char> read_text(Parser& parser, const fs::path& file, const std::string& name, const std::string& included_at) {
  std::error_code error;
  const std::string prefix = included_at.empty() ? "" : included_at + ": ";
  if (!fs::is_regular_file(file, error))
    throw Error(Exit::scene, prefix + file.string() + (fs::exists(file, error) ? ": is not a file" : ": there is no such file"));
  const auto size = fs::file_size(file, error);
  if (error) throw Error(Exit::scene, prefix + file.string() + ": cannot be read");
  parser.text_bytes += size;
  if (size > MAX_TEXT || parser.text_bytes > MAX_TEXT)
    throw Error(Exit::scene, prefix + file.string() + ": the scene is longer than 256 MiB of XML");
  try {
    return read_scene_file(file, name, parser.document.files);
  } catch (const SceneFileError& fault) {
    throw Error(Exit::scene, prefix + file.string() + ": " + fault.what());
  }
}

std::uint32_t read_file(Parser& parser, const fs::path& file, const std::string& name, const std::string& included_at,
                        std::vector<fs::path> search_path, int depth) {
  std::error_code error;
  const fs::path identity = fs::weakly_canonical(file, error);
  if (std::find(parser.open_files.begin(), parser.open_files.end(), identity) != parser.open_files.end())
    refuse(included_at, "<include>: \"" + file.string() + "\" includes itself");
  if (parser.files++ > MAX_INCLUDES)
    refuse(included_at, "<include>: more than " + std::to_string(MAX_INCLUDES) + " files are included");
  parser.open_files.push_back(identity);

  const BufferVector<char> text = read_text(parser, file, name, included_at);
  Source source{file.string(), {}, std::move(search_path)};
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

void refuse(const std::string& where, const std::string& what) {
  // One line of bearable length, whatever the file quotes in it.
  constexpr std::size_t MAX_LINE = 2000;
  std::string line = where + ": " + what;
  for (auto& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  if (line.size() > MAX_LINE) line = line.substr(0, MAX_LINE) + " ...";
  throw Error(Exit::scene, line);
}

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
  read_file(parser, file, "", "", {fs::path(".")}, 0);
  resolve_references(parser);
  check_definitions(parser.substitution);
  return std::move(parser.document);
}

}  // namespace oclair
