#include "terrain_file.h"

#include <bit>
#include <cstring>
#include <fstream>

#include "../color.h"
#include "../error.h"

namespace oclair::bench {
namespace {

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  std::ofstream stream(file, std::ios::binary);
  stream << content;
  if (!stream.flush()) throw Error(Exit::render_failed, file.string() + ": cannot be written, expected room for it");
}

std::string ply_of(const Mesh& mesh) {
  std::string bytes = std::string("ply\nformat binary_") + (std::endian::native == std::endian::little ? "little" : "big") +
                      "_endian 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 12 * mesh.positions.size() + 13 * mesh.triangles.size());
  for (const glm::dvec3& p : mesh.positions) append(bytes, pack(p));
  for (const glm::uvec3& t : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    append(bytes, packed_uint3{t.x, t.y, t.z});
  }
  return bytes;
}

}  // namespace

void write_terrain_scene(const Mesh& mesh, const std::filesystem::path& directory, unsigned size) {
  write_file(directory / "terrain.ply", ply_of(mesh));
  const std::string side = std::to_string(size);
  write_file(directory / "terrain.xml", R"(<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective">
    <float name="fov" value="90"/>
    <float name="near_clip" value="0.0001"/>
    <transform name="to_world"><lookat origin="0, 0.45, 0.95" target="0, -0.35, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value=")" +
                                            side + R"("/><integer name="height" value=")" + side + R"("/>
      <rfilter type="box"/></film>
  </sensor>
  <shape type="ply">
    <string name="filename" value="terrain.ply"/>
    <boolean name="face_normals" value="true"/>
    <bsdf type="twosided"><bsdf type="diffuse"/></bsdf>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><scale value="0.25"/><rotate x="1" angle="90"/><translate y="0.95"/></transform>
    <emitter type="area"><rgb name="radiance" value="10"/></emitter>
  </shape>
</scene>
)");
}

}  // namespace oclair::bench
