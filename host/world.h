// A scene as its file says it: world space, double precision. What the reader returns and host/frame.h places into the
// canonical frame. Radiometric values are linear sRGB triples; lengths are the file's; angles are degrees.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "../cl/types.h"

namespace oclair {

// A triangle mesh in world space. Front is the side from which the vertices run counter-clockwise; where vertex normals
// exist they lie on the front side of every triangle.
struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  // unit, one per position; empty: flat
  std::vector<glm::uvec3> triangles;
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
  std::string where;              // "file:line" of its element, for messages
};

struct WorldLight {
  LightKind kind = LIGHT_POINT;   // LIGHT_POINT, LIGHT_DIRECTIONAL or LIGHT_CONSTANT (one at most)
  glm::dvec3 value{1.0};          // intensity W/sr, irradiance W/m^2 or radiance W/(m^2 sr)
  glm::dvec3 position{0.0};       // point: where; directional: unit direction in which the light travels
};

struct WorldCamera {
  glm::dmat4 to_world{1.0};       // looks along +z with +y up and +x to the LEFT of the image (Mitsuba's convention)
  double tan_half_fov_x = 1.0;    // of the half width of the full film
  glm::dvec2 principal_point_offset{0.0};  // in units of the film's width and height
  double near_clip = 1e-2;
  double far_clip = 1e4;
};

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
  std::vector<Material> materials;
  std::vector<WorldLight> lights;  // not the area lights: those are shapes with a radiance
  WorldCamera camera;
  WorldFilm film;
  WorldIntegrator integrator;
  std::uint64_t samples_per_pixel = 4;
  std::uint64_t seed = 0;
  std::vector<std::string> files;     // every file that was read, the scene file first
  std::vector<std::string> warnings;  // "file:line: ..." one line each
};

}  // namespace oclair
