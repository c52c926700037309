// Mitsuba's serialized meshes: what a writer of its own puts into the file comes out, and whatever is broken is refused.
#include <zlib.h>

#include <bit>
#include <cmath>
#include <optional>

#include "../host/mesh_file.h"
#include "scene_text.h"

namespace oclair {

namespace {

struct Stream {
  int version = 4;
  std::uint32_t flags = 0x1000;  // single precision
  bool doubles = false;
  std::string name = "a shape";
  std::uint64_t vertices = 4, faces = 2;
  std::vector<double> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2};
  std::vector<double> normals, uvs, colors;
  std::vector<std::uint32_t> indices = {0, 1, 2, 0, 1, 3};
  std::string after;
};

std::string little_endian(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
  return bytes;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  EXPECT_EQ(
      compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
      Z_OK);
  return result.substr(0, size);
}

std::string plain(const Stream& s) {
  std::string bytes = little_endian(s.flags, 4);
  if (s.version == 4) bytes += s.name + '\0';
  bytes += little_endian(s.vertices, 8) + little_endian(s.faces, 8);
  for (const auto* values : {&s.positions, &s.normals, &s.uvs, &s.colors})
    for (const double x : *values)
      bytes += s.doubles ? little_endian(std::bit_cast<std::uint64_t>(x), 8)
                         : little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(x)), 4);
  for (const std::uint32_t i : s.indices) bytes += little_endian(i, 4);
  return bytes + s.after;
}

std::string shape(const Stream& s) { return little_endian(0x041C, 2) + little_endian(s.version, 2) + deflated(plain(s)); }

std::string file_of(const std::vector<Stream>& streams) {
  std::string bytes, dictionary;
  for (const Stream& s : streams) {
    dictionary += little_endian(bytes.size(), s.version == 4 ? 8 : 4);
    bytes += shape(s);
  }
  return bytes + dictionary + little_endian(streams.size(), 4);
}

Stream complete() {
  Stream s;
  s.flags |= 0x1 | 0x2 | 0x8;
  s.normals = {0, 0, 1, 0, 3, 0, -1, 0, 0, 0, 0, 2};
  s.uvs = {0, 0, 1, 0, 0.5, -1, 7, 0.25};
  s.colors = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 2, 1};
  return s;
}

std::vector<double> flat(const std::vector<glm::dvec3>& values) {
  std::vector<double> result;
  for (const auto& v : values) result.insert(result.end(), {v.x, v.y, v.z});
  return result;
}

std::string refusal(const std::string& file, std::uint64_t index = 0) {
  try {
    parse_serialized(file, index);
    return "";
  } catch (const MeshFileError& error) {
    return error.what();
  }
}

bool same(const ObjectMesh& a, const ObjectMesh& b) {
  const bool attributes = a.attributes.size() == b.attributes.size() &&
                          (a.attributes.empty() || a.attributes[0].values == b.attributes[0].values);
  return a.positions == b.positions && a.normals == b.normals && a.uvs == b.uvs && a.triangles == b.triangles && attributes;
}

}  // namespace

// 0.1 in double precision is not 0.1f.
TEST(serialized_test, every_variant_gives_the_mesh_that_was_written) {
  for (int variant = 0; variant < 32; ++variant) {
    Stream s = complete();
    s.version = variant & 1 ? 3 : 4;
    s.doubles = variant & 2;
    s.flags = s.doubles ? 0x2000 : 0x1000;
    s.positions[4] = s.doubles ? 0.1 : 0.125;
    variant& 4 ? s.flags |= 0x1 : (s.normals.clear(), 0u);
    variant& 8 ? s.flags |= 0x2 : (s.uvs.clear(), 0u);
    variant& 16 ? s.flags |= 0x8 : (s.colors.clear(), 0u);
    const ObjectMesh mesh = parse_serialized(file_of({s}), 0);
    EXPECT_EQ(flat(mesh.positions), s.positions) << variant;
    EXPECT_EQ(flat(mesh.normals), s.normals) << variant;
    ASSERT_EQ(mesh.uvs.size(), s.uvs.size() / 2) << variant;
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i) EXPECT_EQ(mesh.uvs[i], glm::dvec2(s.uvs[2 * i], s.uvs[2 * i + 1]));
    ASSERT_EQ(mesh.attributes.size(), s.colors.empty() ? 0u : 1u) << variant;
    if (!s.colors.empty()) {
      EXPECT_EQ(mesh.attributes[0].name, "vertex_color");
      EXPECT_FALSE(mesh.attributes[0].per_face);
      EXPECT_EQ(mesh.attributes[0].channels, 3u);
      EXPECT_EQ(mesh.attributes[0].values, std::vector<float>(s.colors.begin(), s.colors.end()));
    }
    EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 3}}));
  }
}

// Measured in Mitsuba 3.9.1: no flag for the precision means single, both mean double; that for face normals (0x10) does
// nothing.
TEST(serialized_test, precision_is_single_unless_double_is_asked_for_and_other_flags_do_nothing) {
  Stream s = complete();
  const ObjectMesh expected = parse_serialized(file_of({s}), 0);
  s.flags = 0x1 | 0x2 | 0x8 | 0x4 | 0x10 | 0x100;
  EXPECT_TRUE(same(parse_serialized(file_of({s}), 0), expected));
  s.doubles = true;
  s.flags |= 0x3000;
  EXPECT_TRUE(same(parse_serialized(file_of({s}), 0), expected));
}

TEST(serialized_test, shapes_are_found_by_their_index) {
  for (const int version : {3, 4}) {
    std::vector<Stream> streams(5);
    for (std::size_t i = 0; i < streams.size(); ++i) {
      streams[i].version = version;
      streams[i].positions[0] = static_cast<double>(i);
      streams[i].name = std::string(i, 'x');
    }
    const std::string file = file_of(streams);
    for (std::size_t i = 0; i < streams.size(); ++i)
      EXPECT_EQ(parse_serialized(file, i).positions[0].x, static_cast<double>(i));
    EXPECT_EQ(refusal(file, 5), "it has 5 shapes, counted from 0: there is none of \"shape_index\" 5");
    EXPECT_EQ(refusal(file, std::uint64_t{1} << 32),
              "it has 5 shapes, counted from 0: there is none of \"shape_index\" 4294967296");
  }
}

TEST(serialized_test, the_first_shape_needs_no_dictionary) {
  EXPECT_EQ(parse_serialized(shape({}), 0).triangles.size(), 2u);
}

TEST(serialized_test, a_mesh_larger_than_every_buffer_is_read) {
  Stream s;
  s.vertices = 100000;
  s.faces = 99998;
  s.positions.clear();
  s.indices.clear();
  for (std::uint32_t i = 0; i < s.vertices; ++i)
    s.positions.insert(s.positions.end(), {std::sin(i), i * 0.5, 1.0 / (i + 1)});
  for (std::uint32_t i = 0; i < s.faces; ++i) s.indices.insert(s.indices.end(), {i, i + 1, i + 2});
  const ObjectMesh mesh = parse_serialized(file_of({s}), 0);
  for (std::size_t i = 0; i < s.vertices; ++i) {
    ASSERT_EQ(mesh.positions[i].x, static_cast<float>(s.positions[3 * i]));
    ASSERT_EQ(mesh.positions[i].z, static_cast<float>(s.positions[3 * i + 2]));
  }
  EXPECT_EQ(mesh.triangles.back(), glm::uvec3(99997, 99998, 99999));
}

TEST(serialized_test, every_truncation_is_refused) {
  for (const int version : {3, 4}) {
    Stream s = complete();
    s.version = version;
    const std::string whole = shape(s);
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
    const std::string plain_bytes = plain(s);
    for (std::size_t size = 0; size < plain_bytes.size(); ++size)
      EXPECT_NE(refusal(whole.substr(0, 4) + deflated(plain_bytes.substr(0, size))), "") << size;
    const std::string two = file_of({s, s});
    for (std::size_t size = 0; size < two.size(); ++size) EXPECT_NE(refusal(two.substr(0, size), 1), "") << size;
  }
}

// The checksum of the stream finds what its structure does not; bits that say how it was compressed may change nothing.
TEST(serialized_test, a_corrupted_byte_is_refused_or_does_not_matter) {
  const std::string file = file_of({complete(), complete()});
  const ObjectMesh expected = parse_serialized(file, 0);
  std::size_t harmless = 0;
  for (std::size_t at = 0; at < file.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string broken = file;
      broken[at] = static_cast<char>(broken[at] ^ 1 << bit);
      for (const std::uint64_t index : {0, 1}) {
        try {
          const ObjectMesh mesh = parse_serialized(broken, index);
          EXPECT_TRUE(same(mesh, expected)) << "byte " << at << " bit " << bit;
          ++harmless;
        } catch (const MeshFileError&) {
        }
      }
    }
  // Of a shape's flips about half are in the other shape, and hit the dictionary or not.
  EXPECT_LT(harmless, file.size() * 8 * 2 * 6 / 10);
}

// The numbers themselves, under a checksum that is right.
TEST(serialized_test, a_corrupted_byte_of_the_contents_is_refused_or_read_as_another_mesh) {
  const Stream s = complete();
  const std::string bytes = plain(s), header = shape(s).substr(0, 4);
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
      std::string broken = bytes;
      broken[at] = static_cast<char>(value);
      try {
        const ObjectMesh mesh = parse_serialized(header + deflated(broken), 0);
        for (const glm::uvec3& t : mesh.triangles)
          for (int corner = 0; corner < 3; ++corner) ASSERT_LT(t[corner], mesh.positions.size());
        for (const glm::dvec3& p : mesh.positions)
          ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      } catch (const MeshFileError&) {
      }
    }
}

TEST(serialized_test, what_is_broken_is_named) {
  const auto with = [](auto change) {
    Stream s = complete();
    change(s);
    return refusal(file_of({s}));
  };
  EXPECT_EQ(refusal(""), "it breaks off");
  EXPECT_EQ(refusal("v 0 0 0\n"), "it does not begin like a serialized mesh");
  EXPECT_EQ(with([](Stream& s) { s.version = 5; }), "version 5 is not known (known: 3, 4)");
  EXPECT_EQ(with([](Stream& s) { s.indices[4] = 4; }), "face 1 names a vertex that is not among the 4");
  EXPECT_EQ(with([](Stream& s) { s.indices.clear(), s.faces = 0; }), "it has no faces");
  EXPECT_EQ(with([](Stream& s) { s.after = "x"; }), "its compressed data go on after the last triangle");
  EXPECT_EQ(with([](Stream& s) { s.positions[7] = NAN; }), "one of its numbers is not finite");
  EXPECT_EQ(with([](Stream& s) { s.uvs[3] = INFINITY; }), "one of its numbers is not finite");
  EXPECT_EQ(with([](Stream& s) { s.normals[5] = s.normals[4] = 0; }), "the normal of vertex 1 is zero");
  EXPECT_EQ(with([](Stream& s) { s.name = std::string(1 << 20, 'n'); }), "the name of the shape is longer than 65536 bytes");
  EXPECT_EQ(with([](Stream& s) { s.doubles = true, s.flags |= 0x2000, s.colors[2] = 1e300; }),
            "one of its colours exceeds the range of single precision");
  const std::string whole = shape({});
  EXPECT_EQ(refusal(whole.substr(0, 4) + "no zlib stream"), "its compressed data are damaged");
  EXPECT_EQ(refusal(whole.substr(0, whole.size() - 1)), "its compressed data break off");
  EXPECT_EQ(refusal(whole + little_endian(1000000, 4), 1), "its dictionary breaks off");
}

// Not one byte is taken for what a file of this size cannot hold.
TEST(serialized_test, counts_beyond_the_reach_of_compression_are_refused_at_once) {
  for (const std::uint64_t count :
       {std::uint64_t{10000000}, (std::uint64_t{1} << 32) - 2, (std::uint64_t{1} << 32) - 1, std::uint64_t{1} << 63}) {
    Stream s;
    s.vertices = count;
    EXPECT_NE(refusal(shape(s)), "");
    s.vertices = 4;
    s.faces = count;
    EXPECT_NE(refusal(shape(s)), "");
  }
  Stream s;
  s.vertices = 10000000;
  EXPECT_EQ(refusal(shape(s)), "it breaks off before its 10000000 vertices and 2 triangles");
}

TEST(serialized_test, a_scene_names_file_and_index) {
  SceneDirectory directory;
  std::vector<Stream> streams(3);
  streams[2] = complete();
  directory.write("a.serialized", file_of(streams));
  const std::string head = SENSOR + "<shape type=\"serialized\"><string name=\"filename\" value=\"a.serialized\"/>";
  const World world =
      directory.read(head + "</shape>" + head.substr(SENSOR.size()) + "<integer name=\"shape_index\" value=\"2\"/></shape>");
  EXPECT_TRUE(world.shapes[0].mesh.uvs.empty());
  EXPECT_EQ(world.shapes[1].mesh.uvs.size(), 4u);
  EXPECT_EQ(world.files.size(), 2u);
  const World faceted = directory.read(
      head + "<integer name=\"shape_index\" value=\"2\"/><boolean name=\"face_normals\" value=\"true\"/></shape>");
  EXPECT_TRUE(faceted.shapes[0].mesh.normals.empty());
}

}  // namespace oclair
