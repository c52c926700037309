#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "parallel.h"
#include "ply_reader.h"

namespace oclair {

namespace {

// Which attributes the properties are, and which number of an attribute each property is.
struct Attributes {
  std::vector<MeshAttribute> list;
  std::vector<std::pair<int, int>> target;  // of each property: attribute and channel, or -1

  void add(const PlyElement& element, const std::string& name, std::initializer_list<std::size_t> properties) {
    const auto at = std::find_if(list.begin(), list.end(), [&](const MeshAttribute& a) { return a.name == name; });
    if (at != list.end()) return;
    MeshAttribute attribute{name, element.name == "face", static_cast<uint>(properties.size()), {}};
    int channel = 0;
    bool floats = true;
    for (const auto p : properties) floats &= !is_integer(element.properties[p].type);
    if (floats) attribute.values.resize(element.count * attribute.channels);
    for (const auto p : properties)
      if (floats) target[p] = {static_cast<int>(list.size()), channel++};
    list.push_back(std::move(attribute));
  }

  // Of the vertex or face whose number that is.
  void set(const std::vector<double>& values, std::uint64_t number) {
    for (std::size_t p = 0; p < target.size(); ++p) {
      if (target[p].first < 0) continue;
      auto& attribute = list[static_cast<std::size_t>(target[p].first)];
      const auto value = static_cast<float>(values[p]);
      if (!std::isfinite(value))
        fail_ply("the attribute " + attribute.name.substr(0, 40) + " of number " + std::to_string(number) + " is not finite");
      attribute.values[number * attribute.channels + static_cast<std::size_t>(target[p].second)] = value;
    }
  }
};

std::optional<std::size_t> property_named(const PlyElement& element, const std::string& name) {
  for (std::size_t i = 0; i < element.properties.size(); ++i)
    if (element.properties[i].name == name && !element.properties[i].count_type) return i;
  return std::nullopt;
}

// Grouped as Mitsuba does, see mesh_file.h. `known` are properties that mean something else.
Attributes attributes_of(const PlyElement& element, const std::vector<std::size_t>& known) {
  const auto& properties = element.properties;
  Attributes result;
  result.target.assign(properties.size(), {-1, 0});
  const std::string kind = element.name + "_";
  for (const auto& names : {std::array{"r", "g", "b"}, std::array{"red", "green", "blue"}}) {
    const auto r = property_named(element, names[0]), g = property_named(element, names[1]),
               b = property_named(element, names[2]);
    if (r && g && b) result.add(element, kind + "color", {*r, *g, *b});
  }
  const auto stem = [&](std::size_t i) {
    if (i >= properties.size() || properties[i].count_type || std::find(known.begin(), known.end(), i) != known.end())
      return std::string();
    const auto end = properties[i].name.rfind('_');
    return end == std::string::npos ? std::string() : properties[i].name.substr(0, end);
  };
  for (std::size_t i = 0; i < properties.size();) {
    const std::string name = stem(i);
    std::string endings;
    std::size_t end = i;
    for (; !name.empty() && stem(end) == name; ++end) endings += properties[end].name.substr(name.size() + 1) + " ";
    for (const std::string whole : {"x y z ", "0 1 2 ", "1 2 3 ", "r g b "}) {
      const std::string attribute = kind + name + (whole[0] == 'r' ? "_color" : "");
      if (endings == whole) result.add(element, attribute, {i, i + 1, i + 2});
      else if (endings == whole.substr(0, 2)) result.add(element, attribute, {i});
    }
    i = std::max(end, i + 1);
  }
  return result;
}

// Bytes of an element's row, if all of its rows are as long; with `corners`, of one whose lists have that many numbers each.
std::optional<std::size_t> row_size(const PlyReader& reader, const PlyElement& element,
                                    std::optional<std::size_t> corners = {}) {
  if (reader.encoding == Encoding::ascii) return std::nullopt;
  std::size_t size = 0;
  for (const auto& property : element.properties) {
    if (property.count_type && !corners) return std::nullopt;
    size += property.count_type ? size_of(*property.count_type) + *corners * size_of(property.type) : size_of(property.type);
  }
  return size;
}

// Rows of that many bytes, by all cores: body(reader, first, end) reads the rows from `first` on from a reader of its own.
template <class Body>
void read_rows(PlyReader& reader, std::size_t size, std::size_t count, const Body& body) {
  parallel_pieces(count, [&](std::size_t first, std::size_t end) {
    PlyReader piece{reader.rest.substr(std::min(first * size, reader.rest.size())), reader.encoding, {}};
    body(piece, first, end);
  });
  reader.rest.remove_prefix(count * size);
}

void read_vertices(PlyReader& reader, const PlyElement& element, ObjectMesh& mesh) {
  constexpr std::array<const char*, 6> NAMES = {"x", "y", "z", "nx", "ny", "nz"};
  std::vector<int> target(element.properties.size(), -1);
  std::vector<std::size_t> known;
  std::array<bool, 8> present{};
  const auto take = [&](std::size_t property, std::size_t meaning) {
    target[property] = static_cast<int>(meaning);
    known.push_back(property);
    if (std::exchange(present[meaning], true)) fail_ply("header: a property of the vertices is given twice");
  };
  for (std::size_t i = 0; i < target.size(); ++i) {
    const auto found = std::find(NAMES.begin(), NAMES.end(), element.properties[i].name);
    if (found != NAMES.end() && !element.properties[i].count_type) take(i, static_cast<std::size_t>(found - NAMES.begin()));
  }
  if (!present[0] || !present[1] || !present[2]) fail_ply("its vertices lack x, y or z");
  for (const auto& names : {std::array{"u", "v"}, std::array{"s", "t"}, std::array{"texture_u", "texture_v"}}) {
    const auto u = property_named(element, names[0]), v = property_named(element, names[1]);
    if (!u || !v || present[6]) continue;
    take(*u, 6);
    take(*v, 7);
  }
  const bool has_normals = present[3] && present[4] && present[5], has_uvs = present[6];
  auto attributes = attributes_of(element, known);
  const std::size_t before = mesh.positions.size(), size = before + element.count;
  mesh.positions.resize(size);
  if (has_normals) mesh.normals.resize(size);
  if (has_uvs) mesh.uvs.resize(size);
  const auto read = [&](PlyReader& rows, std::size_t first, std::size_t end) {
    std::vector<double> all(element.properties.size());
    for (std::size_t v = first; v < end; ++v) {
      double values[8] = {};
      for (std::size_t i = 0; i < target.size(); ++i)
        read_property(rows, element.properties[i], [&](double value) {
          all[i] = value;
          if (target[i] >= 0) values[target[i]] = value;
        });
      for (int i = 0; i < (has_normals ? 6 : 3); ++i)
        if (!std::isfinite(values[i])) fail_ply("vertex " + std::to_string(v) + " is not finite");
      mesh.positions[before + v] = {values[0], values[1], values[2]};
      if (has_normals) mesh.normals[before + v] = {values[3], values[4], values[5]};
      if (has_normals && mesh.normals[before + v] == glm::dvec3(0.0))
        fail_ply("the normal of vertex " + std::to_string(v) + " is zero");
      if (has_uvs) mesh.uvs[before + v] = {values[6], values[7]};
      if (!std::isfinite(values[6]) || !std::isfinite(values[7]))
        fail_ply("the texture coordinates of vertex " + std::to_string(v) + " are not finite");
      attributes.set(all, v);
    }
  };
  if (const auto row = row_size(reader, element)) read_rows(reader, *row, element.count, read);
  else read(reader, 0, element.count);
  std::move(attributes.list.begin(), attributes.list.end(), std::back_inserter(mesh.attributes));
}

// Vertices may come later in the file: polygons are cut at the end.
struct Faces {
  std::vector<glm::uvec3> triangles;      // the first faces, up to the first that is none
  std::vector<std::uint32_t> corners;     // of the others one after another
  std::vector<std::uint32_t> sizes;       // and how many each of them has
  std::vector<MeshAttribute> attributes;  // one value for each face
};

bool is_index_list(const PlyProperty& p) { return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index"); }

// How many triangles the faces begin with, all rows of `size` bytes. 0 unless the index list is the only one.
std::size_t leading_triangles(const PlyReader& reader, const PlyElement& element, std::size_t size) {
  std::size_t offset = 0;
  const PlyProperty* list = nullptr;
  for (const auto& property : element.properties) {
    if (property.count_type && std::exchange(list, &property)) return 0;
    if (!list) offset += size_of(property.type);
  }
  const std::size_t most = std::min<std::size_t>(element.count, reader.rest.size() / size);
  for (std::size_t f = 0; f < most; ++f) {
    PlyReader count{reader.rest.substr(f * size + offset), reader.encoding, {}};
    if (read_scalar(count, *list->count_type) != 3.0) return f;
  }
  return most;
}

void read_faces(PlyReader& reader, const PlyElement& element, std::uint64_t vertex_count, Faces& faces) {
  if (std::count_if(element.properties.begin(), element.properties.end(), is_index_list) != 1)
    fail_ply("its faces lack a list vertex_indices");
  if (!faces.sizes.empty() || !faces.triangles.empty()) fail_ply("it has more than one element \"face\"");
  auto attributes = attributes_of(element, {});
  // Appends the corners of the next face, whose number is f; `all` is room for its properties.
  const auto read_face = [&](PlyReader& rows, std::size_t f, std::vector<double>& all, std::vector<std::uint32_t>& corners) {
    const std::size_t before = corners.size();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto& property = element.properties[i];
      if (!is_index_list(property)) {
        read_property(rows, property, [&](double value) { all[i] = value; });
        continue;
      }
      read_property(rows, property, [&](double value) {
        if (!(value >= 0.0 && value < static_cast<double>(vertex_count)) || value != static_cast<std::uint32_t>(value))
          fail_ply("face " + std::to_string(f) + " names a vertex that is not among the " + std::to_string(vertex_count));
        corners.push_back(static_cast<std::uint32_t>(value));
      });
      if (corners.size() - before < 3) fail_ply("face " + std::to_string(f) + " has fewer than three corners");
    }
    attributes.set(all, f);
  };
  std::size_t triangles = 0;
  if (const auto row = row_size(reader, element, 3)) {
    triangles = leading_triangles(reader, element, *row);
    faces.triangles.resize(triangles);
    read_rows(reader, *row, triangles, [&](PlyReader& rows, std::size_t first, std::size_t end) {
      std::vector<double> all(element.properties.size());
      std::vector<std::uint32_t> corners;
      for (std::size_t f = first; f < end; ++f, corners.clear()) {
        read_face(rows, f, all, corners);
        faces.triangles[f] = {corners[0], corners[1], corners[2]};
      }
    });
  }
  std::vector<double> all(element.properties.size());
  for (std::size_t f = triangles; f < element.count; ++f) {
    const std::size_t before = faces.corners.size();
    read_face(reader, f, all, faces.corners);
    faces.sizes.push_back(static_cast<std::uint32_t>(faces.corners.size() - before));
  }
  faces.attributes = std::move(attributes.list);
}

// A polygon becomes several triangles, each of which has its attributes.
void append_face_attributes(Faces& faces, ObjectMesh& mesh) {
  const std::size_t triangles = faces.triangles.size();
  for (auto& attribute : faces.attributes) {
    const std::size_t whole = std::min(triangles * attribute.channels, attribute.values.size());
    const std::vector<float> rest(attribute.values.begin() + static_cast<std::ptrdiff_t>(whole), attribute.values.end());
    attribute.values.resize(whole);
    for (std::size_t f = 0; f < faces.sizes.size() && !rest.empty(); ++f)
      for (std::uint32_t i = 2; i < faces.sizes[f]; ++i)
        for (uint c = 0; c < attribute.channels; ++c) attribute.values.push_back(rest[f * attribute.channels + c]);
    mesh.attributes.push_back(std::move(attribute));
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
    fail_ply("something follows after its last element");
  if (faces.sizes.empty() && faces.triangles.empty()) fail_ply("it has no faces");
  if (mesh.positions.size() != vertex_count) fail_ply("it has more than one element \"vertex\"");
  append_face_attributes(faces, mesh);
  mesh.triangles = std::move(faces.triangles);
  const auto* corner = faces.corners.data();
  for (const auto size : faces.sizes) {
    append_polygon(mesh, {corner, size});
    corner += size;
  }
  return mesh;
}

}  // namespace oclair
