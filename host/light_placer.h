// Lights on their way to the device, with the power that decides how often each is chosen.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <vector>

#include "material_placer.h"
#include "scene.h"

namespace oclair {

class LightPlacer {
 public:
  explicit LightPlacer(Scene& scene) : scene_(scene) {}

  // Lights of the triangles from shape.first_triangle on; sets first_light and light_split of the shape. texture: 1 + index into
  // Scene::textures of what takes the place of the radiance, or 0.
  void add_mesh(Shape& shape, const glm::dvec3& radiance, uint texture);

  // Light of the last one of Scene::quadrics.
  void add_quadric(Shape& shape, const glm::dvec3& radiance, uint texture);

  void add(const WorldLight& source, MaterialPlacer& materials);

  // The distribution of all lights, and the exponent of the film.
  void finish();

 private:
  void append(const Light& light, double flux, double illumination, double brightest);
  void add_textured_mesh(Shape& shape, uint texture);
  Light triangle(uint primitive) const;
  double brightest_texel_of(uint texture);

  Scene& scene_;
  std::vector<double> flux_;
  std::map<uint, double> brightest_texels_;  // of each texture that shines
  double illumination_ = 0.0;  // irradiance at distance 1, all lights together, the largest channel
  double brightest_ = 0.0;     // radiance of an area light or of a texel around the scene
  std::size_t parts_ = 0;      // of triangles with a textured radiance
};

}  // namespace oclair
