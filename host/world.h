// A scene as its file says it: world space, double precision. What the reader returns and host/frame.h places into the
// canonical frame. Radiometric values are linear sRGB triples; lengths are the file's; angles are degrees.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <cstdint>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../cl/types.h"
#include "scene_file.h"

namespace oclair {

// Numbers (1 channel) or linear sRGB colours (3 channels) on the vertices or the faces of a mesh.
struct MeshAttribute {
  std::string name;           // as a texture asks for it: "vertex_color", "face_heat"
  bool per_face = false;
  uint channels = 3;
  std::vector<float> values;  // channels for each vertex or triangle; none: the file has integers, whose range is unknown
};

// A triangle mesh in world space. Front is the side from which the vertices run counter-clockwise; where vertex normals
// exist they lie on the front side of every triangle.
struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals{};  // unit, one per position; empty: flat
  std::vector<glm::dvec2> uvs{};      // texture coordinates, one per position; empty: none
  std::vector<glm::uvec3> triangles{};
  std::vector<MeshAttribute> attributes{};
};

enum class Geometry { mesh, sphere, disk, cylinder };

struct WorldShape {
  Geometry geometry = Geometry::mesh;
  Mesh mesh;                      // if mesh
  glm::dmat4 to_world{1.0};       // otherwise: from the unit quadric of cl/types.h; columns 0-2 are orthogonal
  bool flip_normals = false;      // otherwise: a mesh has been turned already
  uint material_front = NONE;     // index into World::materials; NONE absorbs
  uint material_back = NONE;
  std::optional<glm::dvec3> radiance;  // emits on its front side
  uint radiance_texture = 0;           // 1 + index into World::textures of what takes its place; radiance is set as well
  std::string where;              // "file:line" of its element, for messages
};

// The pixels of an image file in its own format, rows from top to bottom. At least 1x1.
struct Image {
  uint width = 0, height = 0;
  uint channels = 3;  // 1 or 3; alpha has been left out
  TexelFormat format = TEXEL_U8;
  bool srgb = false;  // the file's integers are encoded as sRGB
  std::vector<std::byte> texels;
};

struct WorldTexture {
  TextureKind kind = TEXTURE_BITMAP;
  std::shared_ptr<const Image> image;  // bitmap; files that several textures name are held once
  bool srgb = false;                   // decode sRGB: not if the scene says that the texture is raw
  bool nearest = false;
  TextureWrap wrap = WRAP_REPEAT;
  glm::dmat3 to_uv{1.0};               // bitmap, checkerboard: acts on (u, v, 1)
  glm::dvec3 color0{0.4}, color1{0.2}; // checkerboard
  std::string attribute;               // name of the mesh's attribute; its kind is that of the attribute
  std::string where;                   // "file:line" of its element, for messages
};

struct WorldLight {
  LightKind kind = LIGHT_POINT;   // not LIGHT_TRIANGLE or LIGHT_QUADRIC; one LIGHT_CONSTANT or LIGHT_ENVIRONMENT at most
  glm::dvec3 value{1.0};          // intensity W/sr, irradiance W/m^2 or radiance W/(m^2 sr); environment: factor of the image
  glm::dvec3 position{0.0};       // point, spot: where; directional: unit direction in which the light travels
  glm::dvec3 axis{0.0, 0.0, 1.0}; // spot: unit direction of its axis
  double cutoff_angle = 20.0;     // spot: half angle of its cone
  double beam_width = 15.0;       // spot: half angle of full intensity
  std::shared_ptr<const Image> image{};  // environment
  glm::dmat3 rotation{1.0};            // environment: from the image's frame to the world
};

struct WorldCamera {
  glm::dmat4 to_world{1.0};       // looks along +z with +y up and +x to the LEFT of the image (Mitsuba's convention)
  double tan_half_fov_x = 1.0;    // of the half width of the full film
  glm::dvec2 principal_point_offset{0.0};  // in units of the film's width and height
  double near_clip = 1e-2;
  double far_clip = 1e4;
  bool orthographic = false;      // then tan_half_fov_x is half the width of the full film, as a length
  double aperture_radius = 0.0;   // of a thin lens; 0: pinhole
  double focus_distance = 1.0;    // depth of the plane in focus
};

inline constexpr uint MAX_FILM_SIDE = 65536;  // pixels

enum class FilterKind { box, tent, gaussian };
enum class PixelFormat { luminance, luminance_alpha, rgb, rgba, xyz, xyza };

struct WorldFilm {
  uint width = 768, height = 576;
  uint crop_x = 0, crop_y = 0, crop_width = 768, crop_height = 576;
  FilterKind filter = FilterKind::gaussian;
  double filter_radius = 2.0;     // box .5; tent: its radius; gaussian: 4 stddev
  double filter_stddev = 0.5;     // gaussian
  bool sample_border = false;
  PixelFormat pixel_format = PixelFormat::rgb;
};

struct WorldIntegrator {
  uint max_depth = std::numeric_limits<uint>::max();  // path segments; 0: nothing, 1: directly visible emission
  uint rr_depth = 5;
  bool hide_emitters = false;
  bool moments = false;           // second-moment channels are wanted
  std::string moment_name;        // and how their names begin
};

struct World {
  std::vector<WorldShape> shapes;
  std::vector<Material> materials;      // lengths (bump_scale) in the world's
  std::vector<WorldTexture> textures;
  std::vector<WorldLight> lights;  // not the area lights: those are shapes with a radiance
  WorldCamera camera;
  WorldFilm film;
  WorldIntegrator integrator;
  std::uint64_t samples_per_pixel = 4;
  std::uint64_t seed = 0;
  SamplerKind sampler = SAMPLER_INDEPENDENT;
  bool keep_uvs = false;              // texture coordinates go to the device even where no texture asks for them
  std::vector<SceneFile> files;       // each that was read, in the order of first reading: the scene file first
  std::vector<std::string> warnings;  // "file:line: ..." one line each
};

}  // namespace oclair
