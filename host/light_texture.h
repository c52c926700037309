// The texture of an area light as light sampling sees it: into how many parts the triangles are split (cl/light.h), and the mean
// radiance of each.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene.h"

namespace oclair {

// Host twin of LightPart in cl/light.h.
struct TrianglePart {
  double b1, b2, size;
};
TrianglePart triangle_part(uint part, uint split);

struct LightTexture {
  uint split = 1;
  std::vector<glm::dvec3> parts;  // mean radiance of part k of triangle i at i * split^2 + k
  glm::dvec3 mean{0.0};           // over the area; not 0 if `brightest` is not
  double brightest = 0.0;         // at least what any point sends, any channel
};

inline constexpr uint MAX_LIGHT_SPLIT = 32;
inline constexpr std::size_t MAX_SHAPE_PARTS = std::size_t{1} << 18, MAX_PARTS = std::size_t{1} << 20;

// At least what any point of a bitmap or checkerboard sends: interpolation stays between the texels. 0 of an attribute. It goes
// through the whole image: to be asked once for each texture.
double brightest_texel(const Scene& scene, uint texture);

// Of the triangles from shape.first_triangle on. `brightest`: brightest_texel(). `parts`: how many the lights before it have.
LightTexture light_texture(const Scene& scene, const Shape& shape, uint texture, double brightest, std::size_t parts);

// Of a quadric: the mean alone.
LightTexture light_texture(const Scene& scene, const Quadric& quadric, uint texture, double brightest);

}  // namespace oclair
