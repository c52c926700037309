#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

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
    for (const auto p : properties)
      if (floats) target[p] = {static_cast<int>(list.size()), channel++};
    list.push_back(std::move(attribute));
  }

  // Of the vertex or face whose number that is.
  void append(const std::vector<double>& values, std::uint64_t number) {
    for (std::size_t p = 0; p < target.size(); ++p) {
      if (target[p].first < 0) continue;
      auto& attribute = list[static_cast<std::size_t>(target[p].first)];
      const auto value = static_cast<float>(values[p]);
      if (!std::isfinite(value))
        fail_ply("the attribute " + attribute.name.substr(0, 40) + " of number " + std::to_string(number) + " is not finite");
      attribute.values.resize((number + 1) * attribute.channels);
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
  std::vector<double> all(element.properties.size());
  for (std::uint64_t v = 0; v < element.count; ++v) {
    double values[8] = {};
    for (std::size_t i = 0; i < target.size(); ++i)
      read_property(reader, element.properties[i], [&](double value) {
        all[i] = value;
        if (target[i] >= 0) values[target[i]] = value;
      });
    for (int i = 0; i < (has_normals ? 6 : 3); ++i)
      if (!std::isfinite(values[i])) fail_ply("vertex " + std::to_string(v) + " is not finite");
    mesh.positions.push_back({values[0], values[1], values[2]});
    if (has_normals) mesh.normals.push_back({values[3], values[4], values[5]});
    if (has_normals && mesh.normals.back() == glm::dvec3(0.0))
      fail_ply("the normal of vertex " + std::to_string(v) + " is zero");
    if (has_uvs) mesh.uvs.push_back({values[6], values[7]});
    if (!std::isfinite(values[6]) || !std::isfinite(values[7]))
      fail_ply("the texture coordinates of vertex " + std::to_string(v) + " are not finite");
    attributes.append(all, v);
  }
  std::move(attributes.list.begin(), attributes.list.end(), std::back_inserter(mesh.attributes));
}

// Corners of all faces one after another, and how many each has: vertices may come later in the file.
struct Faces {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> sizes;
  std::vector<MeshAttribute> attributes;  // one value for each face
};

void read_faces(PlyReader& reader, const PlyElement& element, std::uint64_t vertex_count, Faces& faces) {
  const auto is_index_list = [](const PlyProperty& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  };
  if (std::count_if(element.properties.begin(), element.properties.end(), is_index_list) != 1)
    fail_ply("its faces lack a list vertex_indices");
  if (!faces.sizes.empty()) fail_ply("it has more than one element \"face\"");
  auto attributes = attributes_of(element, {});
  std::vector<double> all(element.properties.size());
  for (std::uint64_t f = 0; f < element.count; ++f) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto& property = element.properties[i];
      if (!is_index_list(property)) {
        read_property(reader, property, [&](double value) { all[i] = value; });
        continue;
      }
      const std::size_t first = faces.corners.size();
      read_property(reader, property, [&](double value) {
        if (!(value >= 0.0 && value < static_cast<double>(vertex_count)) || value != std::floor(value))
          fail_ply("face " + std::to_string(f) + " names a vertex that is not among the " + std::to_string(vertex_count));
        faces.corners.push_back(static_cast<std::uint32_t>(value));
      });
      faces.sizes.push_back(static_cast<std::uint32_t>(faces.corners.size() - first));
      if (faces.sizes.back() < 3) fail_ply("face " + std::to_string(f) + " has fewer than three corners");
    }
    attributes.append(all, f);
  }
  faces.attributes = std::move(attributes.list);
}

// A polygon becomes several triangles, each of which has its attributes.
void append_face_attributes(const Faces& faces, ObjectMesh& mesh) {
  for (const auto& source : faces.attributes) {
    MeshAttribute attribute{source.name, true, source.channels, {}};
    for (std::size_t f = 0; f < faces.sizes.size() && !source.values.empty(); ++f)
      for (std::uint32_t i = 2; i < faces.sizes[f]; ++i)
        for (uint c = 0; c < source.channels; ++c) attribute.values.push_back(source.values[f * source.channels + c]);
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
  if (faces.sizes.empty()) fail_ply("it has no faces");
  if (mesh.positions.size() != vertex_count) fail_ply("it has more than one element \"vertex\"");
  const auto* corner = faces.corners.data();
  for (const auto size : faces.sizes) {
    append_polygon(mesh, {corner, size});
    corner += size;
  }
  append_face_attributes(faces, mesh);
  return mesh;
}

}  // namespace oclair
