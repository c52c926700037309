// Meshes made in code.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include "../world.h"

namespace oclair::test {

inline void add_triangle(Mesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const auto first = static_cast<unsigned>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

// Parallelogram origin, origin + x, origin + x + y, origin + y; its front is where x cross y points.
inline void add_quad(Mesh& mesh, glm::dvec3 origin, glm::dvec3 x, glm::dvec3 y) {
  const auto first = static_cast<unsigned>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {origin, origin + x, origin + x + y, origin + y});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

// Axis-aligned box [low, high] with its front outside, or inside.
inline void add_box(Mesh& mesh, glm::dvec3 low, glm::dvec3 high, bool inside = false) {
  const glm::dvec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  const auto face = [&](glm::dvec3 o, glm::dvec3 a, glm::dvec3 b) { inside ? add_quad(mesh, o, b, a) : add_quad(mesh, o, a, b); };
  face(low, y, x);
  face(low + z, x, y);
  face(low, z, y);
  face(low + x, y, z);
  face(low, x, z);
  face(low + y, z, x);
}

// Closed sphere-like mesh: an icosahedron, each triangle split into 4 `levels` times, radii displaced by up to `displacement`.
inline Mesh icosphere(int levels, double displacement, unsigned seed) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Mesh mesh;
  mesh.positions = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middle;
    const auto split = [&](unsigned a, unsigned b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<unsigned>(mesh.positions.size()));
      if (fresh) mesh.positions.push_back(mesh.positions[a] + mesh.positions[b]);
      return at->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : mesh.triangles) {
      const unsigned ab = split(t.x, t.y), bc = split(t.y, t.z), ca = split(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
    for (glm::dvec3& p : mesh.positions) p = glm::normalize(p);
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-displacement, displacement);
  for (glm::dvec3& p : mesh.positions) p = glm::normalize(p) * (1.0 + shift(random));
  return mesh;
}

// Surface of a cube of n x n squares a side, two triangles each, all coordinates dyadic.
inline Mesh grid_cube(int n) {
  Mesh mesh;
  std::map<std::array<int, 3>, unsigned> known;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [at, fresh] = known.try_emplace(p, static_cast<unsigned>(mesh.positions.size()));
    if (fresh) mesh.positions.push_back(glm::dvec3(p[0], p[1], p[2]) * (2.0 / n) - 1.0);
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = i + a;
            p[(axis + 2) % 3] = j + b;
            return vertex(p);
          };
          mesh.triangles.emplace_back(corner(0, 0), corner(1, 0), corner(1, 1));
          mesh.triangles.emplace_back(corner(0, 0), corner(1, 1), corner(0, 1));
        }
  return mesh;
}

}  // namespace oclair::test
