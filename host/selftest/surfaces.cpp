#include "groups.h"
#include "leaving_rays.h"

namespace oclair::selftest {
namespace {

Scene placed(WorldShape shape) {
  World world;
  world.materials.push_back({});
  shape.material_front = shape.material_back = 0;
  world.shapes.push_back(std::move(shape));
  return place_scene(world);
}

Scene placed(const Mesh& mesh) {
  WorldShape shape;
  shape.mesh = mesh;
  return placed(shape);
}

// The cube's walls meet at right angles, the ball's at flat ones; turned, the cube has no exact coordinates.
std::vector<Scene> closed_rooms() {
  Mesh cube, turned;
  add_box(cube, {-1, -1, -1}, {1, 1, 1}, true);
  const glm::dmat3 turn(glm::normalize(glm::dvec3(1, 2, 3)), glm::normalize(glm::dvec3(-2, 1, 0)),
                        glm::normalize(glm::dvec3(-3, -6, 5)));
  add_box(turned, {-1, -0.8, -0.9}, {1, 0.8, 0.9}, true);
  for (glm::dvec3& p : turned.positions) p = turn * p;
  WorldShape sphere;
  sphere.geometry = Geometry::sphere;
  std::vector<Scene> rooms;
  rooms.push_back(placed(cube));
  rooms.push_back(placed(turned));
  rooms.push_back(placed(icosphere(2, 0.05, 5)));
  rooms.push_back(placed(sphere));
  return rooms;
}

// Triangles at several scales and distances from the origin, each left at one place.
void leave_triangles(const Session& session, Group& group) {
  Random random(13);
  std::size_t rays = 0, again_total = 0;
  double largest = 0.0;
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double distance : {0.0, 1e5}) {
      const Scene scene = placed(triangles_in(distance * glm::dvec3(1.0, -0.7, 0.3), scale, 10000, random));
      const Bvh bvh = build_bvh(scene, session.device.bvh_width);
      const std::vector<Hit> hits = hits_everywhere(scene, bvh, scene.triangles.size(), random);
      std::vector<packed_float3> w, offset(hits.size());
      for (std::size_t i = 0; i < hits.size(); ++i) w.push_back(packed(leaving_direction(scene, hits[i], i, random)));
      std::vector<cl_uint> again(hits.size());
      run(session, "leave", hits.size(), bvh.blocks, scene.shapes, scene.triangle_shape, hits, w, out(offset), out(again));
      rays += hits.size();
      again_total += static_cast<std::size_t>(std::count(again.begin(), again.end(), 1u));
      for (const packed_float3& o : offset) keep_worst(largest, glm::length(unpacked(o)));
    }
  group.measure("rays", static_cast<double>(rays));
  group.bound("that hit their own triangle", static_cast<double>(again_total), 0);
  group.bound("largest offset", largest, 9 * std::sqrt(3.0) * unit_roundoff);
}

void walk_rooms(const Session& session, Group& group) {
  constexpr std::size_t paths = 320;
  constexpr cl_uint bounces = 500;
  Random random(14);
  std::size_t left = 0, walked = 0;
  for (const Scene& scene : closed_rooms()) {
    const Bvh bvh = build_bvh(scene, session.device.bvh_width);
    std::vector<Ray> start;
    for (std::size_t i = 0; i < paths; ++i)
      start.push_back({packed(random.in_cube(0.05)), 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
    std::vector<cl_uint> survived(paths);
    run(session, "walk", paths, bvh.nodes, bvh.blocks, scene.quadrics, scene.shapes, scene.triangle_shape, start, bounces,
        out(survived));
    for (const cl_uint n : survived) {
      left += n != bounces;
      walked += n;
    }
  }
  group.measure("bounces", static_cast<double>(walked));
  group.bound("paths out of closed rooms", static_cast<double>(left), 0);
}

}  // namespace

// A ray that leaves a triangle does not hit it again, even where nothing leaves the triangle out; and it starts no further
// off than 8 u in each axis, the bound of a point's error in [-1, 1]^3, and 1 u of rounding. Paths of diffuse bounces in
// closed rooms stay there.
void check_surfaces(const Session& session, Group& group) {
  leave_triangles(session, group);
  walk_rooms(session, group);
}

}  // namespace oclair::selftest
