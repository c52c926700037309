#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "mesh_file.h"
#include "number.h"

namespace oclair {

namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyReader {
  std::string_view rest;
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
};

[[noreturn]] void fail(const std::string& what) { throw MeshFileError(what); }

std::optional<Scalar> scalar_named(std::string_view name) {
  constexpr std::array<const char*, 16> NAMES = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                                 "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                                 "float",  "float32", "double", "float64"};
  const auto found = std::find(NAMES.begin(), NAMES.end(), name);
  if (found == NAMES.end()) return std::nullopt;
  return static_cast<Scalar>((found - NAMES.begin()) / 2);
}

std::size_t size_of(Scalar type) {
  constexpr std::size_t SIZES[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return SIZES[static_cast<int>(type)];
}

bool is_integer(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

std::string_view next_word(std::string_view& text) {
  constexpr std::string_view BLANKS = " \t\r\n";
  const auto begin = text.find_first_not_of(BLANKS);
  if (begin == std::string_view::npos) return text = {};
  text.remove_prefix(begin);
  const auto word = text.substr(0, text.find_first_of(BLANKS));
  text.remove_prefix(word.size());
  return word;
}

Scalar type_in_header(std::string_view& line) {
  const auto word = next_word(line);
  const auto type = scalar_named(word);
  if (!type) fail("header: \"" + std::string(word.substr(0, 40)) + "\" is not a type");
  return *type;
}

void read_header_line(PlyReader& reader, std::string_view line, bool& has_format) {
  const std::string word(next_word(line));
  if (word == "format") {
    const auto format = next_word(line), version = next_word(line);
    if (format == "ascii")
      reader.encoding = Encoding::ascii;
    else if (format == "binary_little_endian")
      reader.encoding = Encoding::little_endian;
    else if (format == "binary_big_endian")
      reader.encoding = Encoding::big_endian;
    else
      fail("header: format \"" + std::string(format.substr(0, 40)) + "\" is not known");
    if (version != "1.0") fail("header: version 1.0 is expected");
    has_format = true;
  } else if (word == "element") {
    PlyElement element;
    element.name = next_word(line);
    const auto count = parse_integer(next_word(line));
    if (!count || *count < 0 || *count >= static_cast<std::int64_t>(NONE))
      fail("header: the number of \"" + element.name.substr(0, 40) + "\" is not one");
    element.count = static_cast<std::uint64_t>(*count);
    reader.elements.push_back(element);
  } else if (word == "property") {
    if (reader.elements.empty()) fail("header: a property stands before the first element");
    PlyProperty property;
    auto after = line;
    if (next_word(after) == "list") {
      line = after;
      property.count_type = type_in_header(line);
      if (!is_integer(*property.count_type)) fail("header: the length of a list is not an integer");
    }
    property.type = type_in_header(line);
    property.name = next_word(line);
    reader.elements.back().properties.push_back(property);
  } else if (word != "comment" && word != "obj_info" && !word.empty()) {
    fail("header: \"" + word.substr(0, 40) + "\" is not known");
  }
}

void read_header(PlyReader& reader) {
  const auto next_line = [&]() -> std::string_view {
    const auto end = reader.rest.find('\n');
    if (end == std::string_view::npos) fail("the header breaks off");
    auto line = reader.rest.substr(0, end);
    reader.rest.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  };
  if (reader.rest.substr(0, 3) != "ply" || next_line() != "ply") fail("it does not begin with \"ply\"");
  bool has_format = false;
  for (auto line = next_line(); line != "end_header"; line = next_line()) read_header_line(reader, line, has_format);
  if (!has_format) fail("header: the format is missing");
  // Every element takes at least one byte, so that no count can promise more than the file holds.
  for (const auto& element : reader.elements)
    if (element.count > 0 && (element.properties.empty() || element.count > reader.rest.size()))
      fail("it breaks off before its " + std::to_string(element.count) + " elements \"" + element.name.substr(0, 40) + "\"");
}

template <typename T>
double decode(std::string_view bytes, Encoding encoding) {
  char buffer[sizeof(T)];
  std::memcpy(buffer, bytes.data(), sizeof(T));
  const bool host_is_little = std::endian::native == std::endian::little;
  if (host_is_little != (encoding == Encoding::little_endian)) std::reverse(buffer, buffer + sizeof(T));
  T value;
  std::memcpy(&value, buffer, sizeof(T));
  return static_cast<double>(value);
}

// The next number, exactly: doubles hold all of the types.
double read_scalar(PlyReader& reader, Scalar type) {
  if (reader.encoding == Encoding::ascii) {
    const auto word = next_word(reader.rest);
    if (word.empty()) fail("it breaks off");
    const auto number = parse_number(word);
    if (!number) fail("\"" + std::string(word.substr(0, 40)) + "\" is not a finite number");
    if (is_integer(type) && *number != std::floor(*number))
      fail("\"" + std::string(word.substr(0, 40)) + "\" is not an integer");
    return *number;
  }
  const auto bytes = reader.rest.substr(0, size_of(type));
  if (bytes.size() < size_of(type)) fail("it breaks off");
  reader.rest.remove_prefix(bytes.size());
  switch (type) {
    case Scalar::int8:
      return decode<std::int8_t>(bytes, reader.encoding);
    case Scalar::uint8:
      return decode<std::uint8_t>(bytes, reader.encoding);
    case Scalar::int16:
      return decode<std::int16_t>(bytes, reader.encoding);
    case Scalar::uint16:
      return decode<std::uint16_t>(bytes, reader.encoding);
    case Scalar::int32:
      return decode<std::int32_t>(bytes, reader.encoding);
    case Scalar::uint32:
      return decode<std::uint32_t>(bytes, reader.encoding);
    case Scalar::float32:
      return decode<float>(bytes, reader.encoding);
    case Scalar::float64:
      return decode<double>(bytes, reader.encoding);
  }
  fail("a type is not known");
}

// Calls visit(value) for each number of the property; a length that the file cannot hold ends in "it breaks off".
template <typename Visit>
void read_property(PlyReader& reader, const PlyProperty& property, Visit visit) {
  if (!property.count_type) return visit(read_scalar(reader, property.type));
  const double count = read_scalar(reader, *property.count_type);
  if (count < 0.0) fail("the length of a list is negative");
  for (double i = 0.0; i < count; ++i) visit(read_scalar(reader, property.type));
}

void read_vertices(PlyReader& reader, const PlyElement& element, ObjectMesh& mesh) {
  constexpr std::array<const char*, 6> NAMES = {"x", "y", "z", "nx", "ny", "nz"};
  std::vector<int> target(element.properties.size(), -1);
  std::array<bool, 6> present{};
  for (std::size_t i = 0; i < target.size(); ++i) {
    const auto found = std::find(NAMES.begin(), NAMES.end(), element.properties[i].name);
    if (found == NAMES.end() || element.properties[i].count_type) continue;
    target[i] = static_cast<int>(found - NAMES.begin());
    if (std::exchange(present[target[i]], true)) fail("header: a property of the vertices is given twice");
  }
  if (!present[0] || !present[1] || !present[2]) fail("its vertices lack x, y or z");
  const bool has_normals = present[3] && present[4] && present[5];
  for (std::uint64_t v = 0; v < element.count; ++v) {
    double values[6] = {};
    for (std::size_t i = 0; i < target.size(); ++i)
      read_property(reader, element.properties[i], [&](double value) {
        if (target[i] >= 0) values[target[i]] = value;
      });
    for (int i = 0; i < (has_normals ? 6 : 3); ++i)
      if (!std::isfinite(values[i])) fail("vertex " + std::to_string(v) + " is not finite");
    mesh.positions.push_back({values[0], values[1], values[2]});
    if (has_normals) mesh.normals.push_back({values[3], values[4], values[5]});
    if (has_normals && mesh.normals.back() == glm::dvec3(0.0))
      fail("the normal of vertex " + std::to_string(v) + " is zero");
  }
}

// Corners of all faces one after another, and how many each has: vertices may come later in the file.
struct Faces {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> sizes;
};

void read_faces(PlyReader& reader, const PlyElement& element, std::uint64_t vertex_count, Faces& faces) {
  const auto is_index_list = [](const PlyProperty& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  };
  if (std::count_if(element.properties.begin(), element.properties.end(), is_index_list) != 1)
    fail("its faces lack a list vertex_indices");
  for (std::uint64_t f = 0; f < element.count; ++f)
    for (const auto& property : element.properties) {
      if (!is_index_list(property)) {
        read_property(reader, property, [](double) {});
        continue;
      }
      const std::size_t first = faces.corners.size();
      read_property(reader, property, [&](double value) {
        if (!(value >= 0.0 && value < static_cast<double>(vertex_count)) || value != std::floor(value))
          fail("face " + std::to_string(f) + " names a vertex that is not among the " + std::to_string(vertex_count));
        faces.corners.push_back(static_cast<std::uint32_t>(value));
      });
      faces.sizes.push_back(static_cast<std::uint32_t>(faces.corners.size() - first));
      if (faces.sizes.back() < 3) fail("face " + std::to_string(f) + " has fewer than three corners");
    }
}

}  // namespace

ObjectMesh parse_ply(std::string_view bytes) {
  PlyReader reader{bytes, Encoding::ascii, {}};
  read_header(reader);
  std::uint64_t vertex_count = 0;
  for (const auto& element : reader.elements)
    if (element.name == "vertex") vertex_count = element.count;
  ObjectMesh mesh;
  Faces faces;
  for (const auto& element : reader.elements) {
    if (element.name == "vertex")
      read_vertices(reader, element, mesh);
    else if (element.name == "face")
      read_faces(reader, element, vertex_count, faces);
    else
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const auto& property : element.properties) read_property(reader, property, [](double) {});
  }
  if (reader.encoding == Encoding::ascii && !next_word(reader.rest).empty())
    fail("something follows after its last element");
  if (faces.sizes.empty()) fail("it has no faces");
  if (mesh.positions.size() != vertex_count) fail("it has more than one element \"vertex\"");
  const auto* corner = faces.corners.data();
  for (const auto size : faces.sizes) {
    append_polygon(mesh, {corner, size});
    corner += size;
  }
  return mesh;
}

}  // namespace oclair
