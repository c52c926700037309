#include "terrain.h"

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "../color.h"
#include "../frame.h"
#include "../mesh.h"
#include "random.h"

namespace oclair::bench {
namespace {

constexpr double half_width = 0.98;  // of the hills: the box is a little wider
constexpr double deepest = -0.98;    // apex of the cone that closes the hills from below
constexpr std::size_t box_triangles = 12;
constexpr std::size_t boulders = 48;
constexpr double lamp_height = 0.95;

void add_triangle(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c) {
  mesh.triangles.emplace_back(static_cast<uint>(a), static_cast<uint>(b), static_cast<uint>(c));
}

void add_box(Mesh& mesh) {
  const std::size_t first = mesh.positions.size();
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  constexpr int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& f : faces) {
    add_triangle(mesh, first + f[0], first + f[1], first + f[2]);
    add_triangle(mesh, first + f[0], first + f[2], first + f[3]);
  }
}

// A square that shines downwards.
void add_lamp(Mesh& mesh, const glm::dvec3& center, double side) {
  const std::size_t first = mesh.positions.size();
  for (const auto& [x, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    mesh.positions.push_back(center + 0.5 * side * glm::dvec3(x, 0, z));
  add_triangle(mesh, first, first + 1, first + 2);
  add_triangle(mesh, first, first + 2, first + 3);
}

// A number in [0, 1) for each point of a lattice.
double lattice(std::int64_t x, std::int64_t z) {
  return random_unit(static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(z), 7);
}

double value_noise(double x, double z) {
  const double cell_x = std::floor(x), cell_z = std::floor(z);
  const auto ix = static_cast<std::int64_t>(cell_x), iz = static_cast<std::int64_t>(cell_z);
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = smooth(x - cell_x), v = smooth(z - cell_z);
  return glm::mix(glm::mix(lattice(ix, iz), lattice(ix + 1, iz), u),
                  glm::mix(lattice(ix, iz + 1), lattice(ix + 1, iz + 1), u), v);
}

// From -0.7 to about 0.1: six octaves of noise.
double height(double x, double z) {
  double sum = 0.0, amplitude = 0.4, frequency = 2.5;
  for (int octave = 0; octave < 6; ++octave, amplitude *= 0.5, frequency *= 2.0)
    sum += amplitude * value_noise(frequency * x, frequency * z);
  return sum - 0.7;
}

constexpr std::size_t hill_triangles(std::size_t nx, std::size_t nz) { return 2 * nx * nz + 2 * (nx + nz); }

// nx x nz cells of two triangles, closed from below by a cone over their rim; in the first `extra` cells one triangle is
// split into three around a point of its own.
void add_hills(Mesh& mesh, std::size_t nx, std::size_t nz, std::size_t extra) {
  const std::size_t first = mesh.positions.size();
  const auto vertex = [&](std::size_t x, std::size_t z) { return first + z * (nx + 1) + x; };
  for (std::size_t z = 0; z <= nz; ++z)
    for (std::size_t x = 0; x <= nx; ++x) {
      const double px = half_width * (2.0 * static_cast<double>(x) / static_cast<double>(nx) - 1.0);
      const double pz = half_width * (2.0 * static_cast<double>(z) / static_cast<double>(nz) - 1.0);
      mesh.positions.emplace_back(px, height(px, pz), pz);
    }
  for (std::size_t z = 0; z < nz; ++z)
    for (std::size_t x = 0; x < nx; ++x) {
      const std::size_t a = vertex(x, z), b = vertex(x + 1, z), c = vertex(x, z + 1), d = vertex(x + 1, z + 1);
      add_triangle(mesh, b, c, d);
      if (z * nx + x < extra) {
        const std::size_t middle = mesh.positions.size();
        mesh.positions.push_back((mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3.0);
        add_triangle(mesh, a, middle, b);
        add_triangle(mesh, b, middle, c);
        add_triangle(mesh, c, middle, a);
      } else {
        add_triangle(mesh, a, c, b);
      }
    }
  const std::size_t apex = mesh.positions.size();
  mesh.positions.emplace_back(0.0, deepest, 0.0);
  for (std::size_t x = 0; x < nx; ++x) {
    add_triangle(mesh, vertex(x, 0), vertex(x + 1, 0), apex);
    add_triangle(mesh, vertex(x + 1, nz), vertex(x, nz), apex);
  }
  for (std::size_t z = 0; z < nz; ++z) {
    add_triangle(mesh, vertex(0, z + 1), vertex(0, z), apex);
    add_triangle(mesh, vertex(nx, z), vertex(nx, z + 1), apex);
  }
}

constexpr std::size_t boulder_triangles(std::size_t stacks) { return 4 * stacks * (stacks - 1); }

// A sphere of `stacks` x 2 stacks faces with dents in it.
void add_boulder(Mesh& mesh, const glm::dvec3& center, double radius, std::size_t stacks) {
  const std::size_t first = mesh.positions.size(), slices = 2 * stacks;
  const auto surface = [&](double polar, double azimuth) {
    const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
    const double dent = value_noise(3.0 * d.x + 10.0 * center.x, 3.0 * d.z + 10.0 * d.y + 10.0 * center.z);
    return center + radius * (0.8 + 0.2 * dent) * d;
  };
  mesh.positions.push_back(surface(0.0, 0.0));
  for (std::size_t i = 1; i < stacks; ++i)
    for (std::size_t j = 0; j < slices; ++j)
      mesh.positions.push_back(surface(glm::pi<double>() * static_cast<double>(i) / static_cast<double>(stacks),
                                       glm::two_pi<double>() * static_cast<double>(j) / static_cast<double>(slices)));
  mesh.positions.push_back(surface(glm::pi<double>(), 0.0));
  const std::size_t last = mesh.positions.size() - 1;
  const auto vertex = [&](std::size_t i, std::size_t j) { return first + 1 + (i - 1) * slices + j % slices; };
  for (std::size_t j = 0; j < slices; ++j) {
    add_triangle(mesh, first, vertex(1, j + 1), vertex(1, j));
    add_triangle(mesh, last, vertex(stacks - 1, j), vertex(stacks - 1, j + 1));
    for (std::size_t i = 1; i + 1 < stacks; ++i) {
      add_triangle(mesh, vertex(i, j), vertex(i, j + 1), vertex(i + 1, j));
      add_triangle(mesh, vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1));
    }
  }
}

// The largest n for which count(n) is at most `most`.
template <class Count>
std::size_t largest_number(std::size_t most, std::size_t least, Count count) {
  std::size_t n = least;
  while (count(n + 1) <= most) ++n;
  return n;
}

}  // namespace

Mesh terrain(std::size_t triangles) {
  Mesh mesh;
  add_box(mesh);
  // Half of the triangles are boulders, if that is enough for them to be round.
  const std::size_t share = triangles / 2 / boulders;
  if (share >= boulder_triangles(3)) {
    const std::size_t stacks = largest_number(share, 3, boulder_triangles);
    for (std::size_t i = 0; i < boulders; ++i) {
      const double x = 1.7 * random_unit(i, 0) - 0.85, z = 1.7 * random_unit(i, 1) - 0.85,
                   radius = 0.03 + 0.09 * random_unit(i, 2);
      add_boulder(mesh, {x, height(x, z) + 0.6 * radius, z}, radius, stacks);
    }
  }
  const std::size_t rest = triangles - mesh.triangles.size();
  const std::size_t nx = largest_number(rest, 1, [](std::size_t n) { return hill_triangles(n, n); });
  const std::size_t nz = largest_number(rest, nx, [nx](std::size_t n) { return hill_triangles(nx, n); });
  add_hills(mesh, nx, nz, (rest - hill_triangles(nx, nz)) / 2);
  return mesh;
}

Mesh sticks(std::size_t triangles) {
  constexpr double length = 0.25, thickness = 0.004;
  Mesh mesh;
  add_box(mesh);
  for (std::size_t i = 0; mesh.triangles.size() + 4 <= triangles; ++i) {
    const glm::dvec3 center = 1.7 * glm::dvec3(random_unit(i, 0), random_unit(i, 1), random_unit(i, 2)) - 0.85;
    const double y = 2.0 * random_unit(i, 3) - 1.0, azimuth = glm::two_pi<double>() * random_unit(i, 4);
    const double r = std::sqrt(1.0 - y * y);
    const glm::dvec3 along(r * std::cos(azimuth), y, r * std::sin(azimuth));
    const glm::dvec3 across =
        glm::normalize(glm::cross(along, std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(along, across);
    const std::size_t first = mesh.positions.size();
    mesh.positions.push_back(center + 0.5 * length * along);
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = glm::two_pi<double>() * corner / 3.0;
      mesh.positions.push_back(center - 0.5 * length * along +
                               0.5 * thickness * (std::cos(angle) * across + std::sin(angle) * up));
    }
    add_triangle(mesh, first, first + 1, first + 2);
    add_triangle(mesh, first, first + 2, first + 3);
    add_triangle(mesh, first, first + 3, first + 1);
    add_triangle(mesh, first + 1, first + 3, first + 2);
  }
  return mesh;
}

Mesh smooth(const Mesh& mesh) {
  ObjectMesh object;
  object.positions = mesh.positions;
  object.triangles = mesh.triangles;
  return to_world(object, {});
}

Mesh in_box(Mesh mesh) {
  Bounds bounds;
  for (const glm::dvec3& p : mesh.positions) bounds.include(p);
  const glm::dvec3 size = bounds.high - bounds.low, middle = 0.5 * (bounds.low + bounds.high);
  const double scale = 1.4 / largest(size);
  for (glm::dvec3& p : mesh.positions) p = scale * (p - middle) + glm::dvec3(0.0, 0.5 * scale * size.y - 0.99, 0.0);
  mesh.normals.clear();
  mesh.uvs.clear();
  mesh.attributes.clear();
  add_box(mesh);
  return mesh;
}

Mesh lamp() {
  Mesh mesh;
  add_lamp(mesh, {0.0, lamp_height, 0.0}, 0.5);
  return mesh;
}

Mesh small_lamps(std::size_t count) {
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i)
    add_lamp(mesh, {1.9 * random_unit(i, 0) - 0.95, lamp_height - 0.1 * random_unit(i, 1), 1.9 * random_unit(i, 2) - 0.95},
             0.5 / std::sqrt(static_cast<double>(count)));
  return mesh;
}

World world_of(Mesh mesh, Mesh lamps) {
  World world;
  Material grey{};
  grey.kind = MATERIAL_DIFFUSE;
  grey.reflectance = {0.5f, 0.5f, 0.5f};
  world.materials.push_back(grey);
  WorldShape solid;
  solid.mesh = std::move(mesh);
  solid.material_front = solid.material_back = 0;
  world.shapes.push_back(std::move(solid));

  WorldShape light;
  light.mesh = std::move(lamps);
  light.material_front = light.material_back = 0;
  light.radiance = glm::dvec3(10.0);
  world.shapes.push_back(std::move(light));

  const glm::dvec3 eye(0.0, 0.45, 0.95), along = glm::normalize(glm::dvec3(0.0, -0.35, 0.0) - eye);
  const glm::dvec3 left = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), along));
  world.camera.to_world =
      glm::dmat4(glm::dvec4(left, 0), glm::dvec4(glm::cross(along, left), 0), glm::dvec4(along, 0), glm::dvec4(eye, 1));
  world.camera.near_clip = 1e-4;
  world.film.width = world.film.height = world.film.crop_width = world.film.crop_height = 512;
  world.film.filter = FilterKind::box;
  world.film.filter_radius = 0.5;
  return world;
}

}  // namespace oclair::bench
