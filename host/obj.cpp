#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "mesh_file.h"
#include "number.h"

namespace oclair {

namespace {

// What a corner of a face names: indices from 0, NONE for what it leaves out.
struct Corner {
  std::uint32_t position = NONE, texture = NONE, normal = NONE;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    // Odd multipliers of 64 bits, from SplitMix64 (Steele et al. 2014), mix the three indices.
    std::uint64_t h =
        c.position * 0x9e3779b97f4a7c15ull ^ c.texture * 0xbf58476d1ce4e5b9ull ^ c.normal * 0x94d049bb133111ebull;
    return static_cast<std::size_t>(h ^ h >> 29);
  }
};

struct ObjParser {
  std::vector<glm::dvec3> positions, normals;
  std::vector<glm::dvec2> textures;
  // Vertices that corners have become. Nearly every position is used with one pair of texture and normal: that vertex is
  // found without hashing, the others are in `further`.
  std::vector<Corner> corners;              // of each vertex
  std::vector<std::uint32_t> first_vertex;  // of each position, or NONE
  std::unordered_map<Corner, std::uint32_t, CornerHash> further;
  std::size_t line = 0;
  ObjectMesh mesh;
};

[[noreturn]] void fail(const ObjParser& parser, const std::string& what) {
  throw MeshFileError("line " + std::to_string(parser.line) + ": " + what);
}

std::string_view next_word(std::string_view& line) {
  constexpr std::string_view BLANKS = " \t\r";
  const auto begin = line.find_first_not_of(BLANKS);
  if (begin == std::string_view::npos) return line = {};
  line.remove_prefix(begin);
  const auto word = line.substr(0, line.find_first_of(BLANKS));
  line.remove_prefix(word.size());
  return word;
}

template <int COUNT>
glm::vec<COUNT, double> numbers(const ObjParser& parser, std::string_view line) {
  glm::vec<COUNT, double> result;
  for (int i = 0; i < COUNT; ++i) {
    const auto word = next_word(line);
    const auto number = parse_number(word);
    if (!number)
      fail(parser, word.empty() ? std::string(COUNT == 3 ? "three" : "two") + " numbers are expected"
                                : "\"" + std::string(word.substr(0, 40)) + "\" is not a finite number");
    result[i] = *number;
  }
  return result;
}

// 1 is the first, -1 the last so far.
std::uint32_t index_of(const ObjParser& parser, std::string_view word, std::size_t count, const char* what) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size())
    fail(parser, "\"" + std::string(word.substr(0, 40)) + "\" is not an index");
  const std::int64_t index = value < 0 ? value + static_cast<std::int64_t>(count) : value - 1;
  if (index < 0 || index >= static_cast<std::int64_t>(count))
    fail(parser,
         std::string("there is no ") + what + " " + std::to_string(value) + " (there are " + std::to_string(count) + ")");
  return static_cast<std::uint32_t>(index);
}

// position, position/texture, position//normal or position/texture/normal
Corner corner_of(const ObjParser& parser, std::string_view word) {
  Corner corner;
  for (int part = 0; part < 3; ++part) {
    const auto slash = word.find('/');
    const auto index = word.substr(0, slash);
    if (part == 0)
      corner.position = index_of(parser, index, parser.positions.size(), "vertex");
    else if (part == 1 && !index.empty())
      corner.texture = index_of(parser, index, parser.textures.size(), "texture coordinate");
    else if (part == 2 && !index.empty())
      corner.normal = index_of(parser, index, parser.normals.size(), "normal");
    if (slash == std::string_view::npos) return corner;
    word.remove_prefix(slash + 1);
  }
  fail(parser, "a corner of a face names more than three indices");
}

std::uint32_t vertex_of(ObjParser& parser, const Corner& corner) {
  auto& first = parser.first_vertex[corner.position];
  const auto fresh = static_cast<std::uint32_t>(parser.corners.size());
  if (first == NONE) {
    first = fresh;
  } else {
    if (parser.corners[first] == corner) return first;
    const auto [found, is_new] = parser.further.emplace(corner, fresh);
    if (!is_new) return found->second;
  }
  parser.corners.push_back(corner);
  parser.mesh.positions.push_back(parser.positions[corner.position]);
  if (corner.normal != NONE) {
    parser.mesh.normals.push_back(parser.normals[corner.normal]);
    if (parser.mesh.normals.back() == glm::dvec3(0.0)) fail(parser, "the vertex normal is zero");
  }
  const auto with_normal = parser.mesh.normals.size();
  if (with_normal != 0 && with_normal != parser.mesh.positions.size())
    fail(parser, "some corners of faces have a normal, others have none");
  if (corner.texture == NONE) ++parser.mesh.vertices_without_uv;
  if (!parser.textures.empty()) {
    parser.mesh.uvs.resize(parser.mesh.positions.size());
    if (corner.texture != NONE) parser.mesh.uvs.back() = parser.textures[corner.texture];
  }
  return fresh;
}

void read_face(ObjParser& parser, std::string_view line) {
  std::vector<std::uint32_t> corners;
  for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
    if (word[0] == '#') break;
    corners.push_back(vertex_of(parser, corner_of(parser, word)));
  }
  if (corners.size() < 3) fail(parser, "a face has fewer than three corners");
  append_polygon(parser.mesh, corners);
}

}  // namespace

ObjectMesh parse_obj(std::string_view text) {
  ObjParser parser;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    auto line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++parser.line;
    const auto word = next_word(line);
    if (word == "v") {
      parser.positions.push_back(numbers<3>(parser, line));
      parser.first_vertex.push_back(NONE);
    } else if (word == "vn")
      parser.normals.push_back(numbers<3>(parser, line));
    else if (word == "vt")
      parser.textures.push_back(numbers<2>(parser, line));
    else if (word == "f")
      read_face(parser, line);
    if (parser.positions.size() >= NONE || parser.normals.size() >= NONE || parser.textures.size() >= NONE ||
        parser.mesh.positions.size() >= NONE)
      fail(parser, "there are more than 2^32 - 2 vertices");
  }
  if (parser.mesh.triangles.empty()) throw MeshFileError("it has no faces");
  if (parser.mesh.vertices_without_uv == parser.mesh.positions.size()) parser.mesh.uvs.clear();
  if (parser.mesh.uvs.empty()) parser.mesh.vertices_without_uv = 0;
  else parser.mesh.uvs.resize(parser.mesh.positions.size());
  return std::move(parser.mesh);
}

}  // namespace oclair
