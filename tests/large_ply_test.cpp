// PLY files so large that several threads read them: what they say is what was written, of several faults the first is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <limits>

#include "../host/mesh_file.h"
#include "random.h"

namespace oclair {

namespace {

using test::Random;

enum class Format { ascii, binary_little_endian, binary_big_endian };
const Format FORMATS[] = {Format::ascii, Format::binary_little_endian, Format::binary_big_endian};

// Appends numbers to the body of a file. Little-endian memory is taken for granted, which every OpenCL host that we know has.
struct Body {
  Format format;
  std::string text;

  template <class T>
  void add(T value) {
    if (format == Format::ascii) {
      char word[40];
      std::snprintf(word, sizeof word, "%.17g ", static_cast<double>(value));  // 17 digits name a double
      text += word;
      return;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (format == Format::binary_big_endian) std::reverse(bytes, bytes + sizeof(T));
    text.append(bytes, sizeof(T));
  }
};

struct Content {
  std::vector<std::array<float, 8>> vertices;  // position, normal, uv
  std::vector<float> heat;                     // of each vertex
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<float> weight;                   // of each face
};

// Triangles; with `polygons` a quadrilateral in their middle and one at their end.
Content random_content(bool polygons) {
  Random random(7);
  Content c;
  for (int i = 0; i < 20000; ++i) {
    auto& v = c.vertices.emplace_back();
    for (float& x : v) x = static_cast<float>(random.between(-3.0, 3.0));
    c.heat.push_back(static_cast<float>(i));
  }
  for (std::uint32_t i = 0; i < 30001; ++i) {
    auto& face = c.faces.emplace_back();
    const bool polygon = polygons && (i == 12345 || i == 30000);
    for (int k = 0; k < (polygon ? 4 : 3); ++k) face.push_back(random.below(20000));
    c.weight.push_back(static_cast<float>(i) + 0.5f);
  }
  return c;
}

std::string written(const Content& c, Format format, bool faces_first) {
  constexpr const char* NAMES[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  Body vertices{format, {}}, faces{format, {}};
  for (std::size_t v = 0; v < c.vertices.size(); ++v) {
    for (const float x : c.vertices[v]) vertices.add(x);
    vertices.add(c.heat[v]);
  }
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    faces.add(c.weight[f]);
    faces.add(static_cast<std::uint8_t>(c.faces[f].size()));
    for (const std::uint32_t corner : c.faces[f]) faces.add(corner);
  }
  std::string vertex = "element vertex " + std::to_string(c.vertices.size()) + "\n";
  for (const char* const name : {"x", "y", "z", "nx", "ny", "nz", "u", "v", "heat_x"})
    vertex += std::string("property float ") + name + "\n";
  const std::string face = "element face " + std::to_string(c.faces.size()) +
                           "\nproperty float weight_x\nproperty list uchar uint vertex_indices\n";
  return std::string("ply\nformat ") + NAMES[static_cast<int>(format)] + " 1.0\n" +
         (faces_first ? face + vertex : vertex + face) + "end_header\n" + (faces_first ? faces.text + vertices.text : vertices.text + faces.text);
}

void expect_content(const ObjectMesh& mesh, const Content& c) {
  ASSERT_EQ(mesh.positions.size(), c.vertices.size());
  ASSERT_EQ(mesh.normals.size(), c.vertices.size());
  ASSERT_EQ(mesh.uvs.size(), c.vertices.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < c.vertices.size(); ++i) {
    const auto& v = c.vertices[i];
    wrong += mesh.positions[i] != glm::dvec3(v[0], v[1], v[2]) || mesh.normals[i] != glm::dvec3(v[3], v[4], v[5]) ||
             mesh.uvs[i] != glm::dvec2(v[6], v[7]);
  }
  EXPECT_EQ(wrong, 0u);
  std::vector<glm::uvec3> triangles;
  std::vector<float> weight;
  for (std::size_t f = 0; f < c.faces.size(); ++f)
    for (std::size_t i = 2; i < c.faces[f].size(); ++i) {
      triangles.push_back({c.faces[f][0], c.faces[f][i - 1], c.faces[f][i]});
      weight.push_back(c.weight[f]);
    }
  EXPECT_EQ(mesh.triangles, triangles);
  const auto values_of = [&](const std::string& name) {
    const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                    [&](const MeshAttribute& a) { return a.name == name; });
    return found == mesh.attributes.end() ? std::vector<float>{} : found->values;
  };
  EXPECT_EQ(values_of("vertex_heat"), c.heat);
  EXPECT_EQ(values_of("face_weight"), weight);
}

std::string refusal(const std::string& text) {
  try {
    parse_ply(text);
  } catch (const MeshFileError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(large_ply_test, what_is_written_is_read) {
  for (const bool polygons : {false, true})
    for (const Format format : FORMATS)
      for (const bool faces_first : {false, true}) {
        const Content content = random_content(polygons);
        expect_content(parse_ply(written(content, format, faces_first)), content);
      }
}

TEST(large_ply_test, of_several_faults_the_first_is_told) {
  for (const Format format : {Format::binary_little_endian, Format::binary_big_endian}) {
    Content content = random_content(false);
    content.faces[25000][1] = 20000;
    content.faces[29000] = {1, 2};
    EXPECT_EQ(refusal(written(content, format, false)), "face 25000 names a vertex that is not among the 20000");
    content.faces[12345] = {1, 2};
    EXPECT_EQ(refusal(written(content, format, false)), "face 12345 has fewer than three corners");
    content.vertices[19999][1] = std::numeric_limits<float>::infinity();
    content.heat[17000] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(refusal(written(content, format, false)), "the attribute vertex_heat of number 17000 is not finite");
    content.vertices[9000][3] = content.vertices[9000][4] = content.vertices[9000][5] = 0.0f;
    EXPECT_EQ(refusal(written(content, format, false)), "the normal of vertex 9000 is zero");
  }
}

TEST(large_ply_test, a_file_that_breaks_off_is_refused_and_says_so_unless_it_is_wrong_before) {
  const std::string whole = written(random_content(false), Format::binary_little_endian, false);
  Random random(8);
  const std::size_t header = whole.find("end_header\n") + 11;
  for (int i = 0; i < 50; ++i) {
    const std::size_t size = header + random.below(static_cast<std::uint32_t>(whole.size() - header));
    const std::string told = refusal(whole.substr(0, size));
    EXPECT_EQ(told.find("it breaks off"), 0u) << size << ": " << told;
  }
  Content content = random_content(false);
  content.vertices[15000][0] = std::numeric_limits<float>::infinity();
  const std::string text = written(content, Format::binary_little_endian, false);
  EXPECT_EQ(refusal(text.substr(0, header + 16000 * 36)), "it breaks off before its 20000 elements \"vertex\"");
  EXPECT_EQ(refusal(text.substr(0, header + 20000 * 36)), "vertex 15000 is not finite");
  EXPECT_EQ(refusal(text.substr(0, text.size() - 1)), "vertex 15000 is not finite");
}

}  // namespace oclair
