// Mitsuba's serialized meshes, little-endian (documentation of its plugin "serialized"): for each shape a header of two
// 16-bit words, 0x041C and the version (3 or 4), and a zlib stream; after all of them their offsets in the file (32 bits in
// version 3, 64 in version 4) and how many there are. The stream: flags; in version 4 a name that ends with a zero; two
// 64-bit counts, of vertices and triangles; positions; normals, texture coordinates and colours if a flag says so; three
// indices for each triangle.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "mesh_file.h"

namespace oclair {

namespace {

constexpr std::uint64_t MAGIC = 0x041C;
enum Flag : std::uint32_t { NORMALS = 0x1, UVS = 0x2, COLORS = 0x8, DOUBLE_PRECISION = 0x2000 };  // Mitsuba reads no others
constexpr std::size_t MAX_NAME = 1 << 16;                                                         // bytes
constexpr std::uint64_t GREATEST_RATIO = 1032;  // of a deflate stream (zlib's technical details): 258 bytes from two bits

[[noreturn]] void fail(const std::string& what) { throw MeshFileError(what); }

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// The integer of `size` bytes at `offset`.
std::uint64_t integer_at(std::string_view file, std::uint64_t offset, std::size_t size) {
  if (offset > file.size() || file.size() - offset < size) fail("it breaks off");
  return little_endian(file.substr(offset, size));
}

class Inflater {
 public:
  explicit Inflater(std::string_view compressed) : rest_(compressed) {
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  std::uint64_t read_integer(std::size_t size) {
    std::array<char, 8> bytes;
    for (std::size_t i = 0; i < size; ++i) {
      if (at_ == filled_ && !fill()) fail("its compressed data break off");
      bytes[i] = buffer_[at_++];
    }
    return little_endian({bytes.data(), size});
  }

  double read_real(std::size_t size) {
    const double value = size == 8 ? std::bit_cast<double>(read_integer(8))
                                   : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(read_integer(4))));
    if (!std::isfinite(value)) fail("one of its numbers is not finite");
    return value;
  }

  // Reaching the end verifies the checksum.
  bool at_end() { return at_ == filled_ && !fill(); }

  // No stream holds more than this.
  std::uint64_t greatest_rest() const {
    return filled_ - at_ + (rest_.size() + stream_.avail_in) * GREATEST_RATIO + buffer_.size();
  }

 private:
  bool fill() {
    at_ = filled_ = 0;
    while (filled_ == 0 && !ended_) {
      if (stream_.avail_in == 0) {
        const std::size_t piece = std::min<std::size_t>(rest_.size(), 1u << 30);
        if (piece == 0) fail("its compressed data break off");
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest_.data()));
        stream_.avail_in = static_cast<uInt>(piece);
        rest_.remove_prefix(piece);
      }
      stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result == Z_MEM_ERROR) throw std::bad_alloc();
      if (result != Z_OK && result != Z_STREAM_END) fail("its compressed data are damaged");
      ended_ = result == Z_STREAM_END;
      filled_ = buffer_.size() - stream_.avail_out;
    }
    return filled_ > 0;
  }

  z_stream stream_{};
  std::string_view rest_;  // not yet given to the stream
  std::array<char, 1 << 16> buffer_;
  std::size_t at_ = 0, filled_ = 0;
  bool ended_ = false;
};

// Where the header of the shape begins.
std::uint64_t offset_of(std::string_view file, std::uint64_t version, std::uint64_t shape_index) {
  if (shape_index == 0) return 0;  // without a look at the dictionary, which a file of one shape may lack
  const std::size_t entry = version == 4 ? 8 : 4;
  const std::uint64_t count = integer_at(file, file.size() - 4, 4);
  if (count > (file.size() - 4) / entry) fail("its dictionary breaks off");
  if (shape_index >= count)
    fail("it has " + std::to_string(count) + " shapes, counted from 0: there is none of \"shape_index\" " +
         std::to_string(shape_index));
  return integer_at(file, file.size() - 4 - entry * (count - shape_index), entry);
}

std::uint64_t read_version(std::string_view file, std::uint64_t offset) {
  if (integer_at(file, offset, 2) != MAGIC) fail("it does not begin like a serialized mesh");
  const std::uint64_t version = integer_at(file, offset + 2, 2);
  if (version != 3 && version != 4) fail("version " + std::to_string(version) + " is not known (known: 3, 4)");
  return version;
}

}  // namespace

ObjectMesh parse_serialized(std::string_view file, std::uint64_t shape_index) {
  const std::uint64_t offset = offset_of(file, read_version(file, 0), shape_index), version = read_version(file, offset);
  Inflater in(file.substr(offset + 4));
  const auto flags = static_cast<std::uint32_t>(in.read_integer(4));
  if (version == 4)
    for (std::size_t length = 0; in.read_integer(1) != 0; ++length)
      if (length >= MAX_NAME) fail("the name of the shape is longer than 65536 bytes");
  const std::uint64_t vertices = in.read_integer(8), faces = in.read_integer(8);
  if (vertices >= NONE || faces >= NONE) fail("it promises 2^32 - 1 vertices or triangles or more");
  const std::size_t real = flags & DOUBLE_PRECISION ? 8 : 4;
  const std::size_t reals = 3 + (flags & NORMALS ? 3 : 0) + (flags & UVS ? 2 : 0) + (flags & COLORS ? 3 : 0);
  if (vertices * reals * real + faces * 12 > in.greatest_rest())
    fail("it breaks off before its " + std::to_string(vertices) + " vertices and " + std::to_string(faces) + " triangles");
  if (faces == 0) fail("it has no faces");

  ObjectMesh mesh;
  const auto read_vectors = [&](std::vector<glm::dvec3>& values) {
    values.resize(vertices);
    for (auto& v : values)
      for (int axis = 0; axis < 3; ++axis) v[axis] = in.read_real(real);
  };
  read_vectors(mesh.positions);
  if (flags & NORMALS) {
    read_vectors(mesh.normals);
    for (std::size_t i = 0; i < vertices; ++i)
      if (mesh.normals[i] == glm::dvec3(0.0)) fail("the normal of vertex " + std::to_string(i) + " is zero");
  }
  if (flags & UVS) {
    mesh.uvs.resize(vertices);
    for (auto& uv : mesh.uvs)
      for (int axis = 0; axis < 2; ++axis) uv[axis] = in.read_real(real);
  }
  if (flags & COLORS) {
    auto& colors = mesh.attributes.emplace_back();
    colors.name = "vertex_color";
    colors.values.resize(3 * vertices);
    for (auto& value : colors.values) {
      value = static_cast<float>(in.read_real(real));
      if (!std::isfinite(value)) fail("one of its colours exceeds the range of single precision");
    }
  }
  mesh.triangles.resize(faces);
  for (std::size_t f = 0; f < faces; ++f)
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint64_t vertex = in.read_integer(4);
      if (vertex >= vertices)
        fail("face " + std::to_string(f) + " names a vertex that is not among the " + std::to_string(vertices));
      mesh.triangles[f][corner] = static_cast<std::uint32_t>(vertex);
    }
  if (!in.at_end()) fail("its compressed data go on after the last triangle");
  return mesh;
}

}  // namespace oclair
