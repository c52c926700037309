// Adversarial inputs of the tree builder (extreme X17): it succeeds, traversal finds what brute force finds, and the stack that
// Bvh::stack_size asks for is enough.
#include <bit>

#include "extremes.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Corners small_triangle(const glm::dvec3& at, double size, Random& random) {
  return {packed(at + random.in_cube(size)), packed(at + random.in_cube(size)), packed(at + random.in_cube(size))};
}

std::vector<Corners> uniform(std::size_t n, Random& random) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < n; ++i) triangles.push_back(small_triangle(random.in_cube(0.99), 0.01, random));
  return triangles;
}

std::vector<Corners> duplicates(std::size_t n, Random& random) {
  return std::vector<Corners>(n, small_triangle({0.1, 0.2, 0.3}, 0.5, random));
}

std::vector<Corners> geometric(std::size_t n, double ratio, Random& random) {
  std::vector<Corners> triangles;
  double x = 1.0;
  for (std::size_t i = 0; i < n; ++i, x *= ratio) triangles.push_back(small_triangle(glm::dvec3(x * 0.9, 0, 0), 0.09 * x, random));
  return triangles;
}

std::vector<Corners> clusters(std::size_t n, std::size_t each, Random& random) {
  std::vector<Corners> triangles;
  double x = 1.0;
  for (std::size_t i = 0; i < n; ++i, x *= 0.5)
    for (std::size_t k = 0; k < each; ++k) triangles.push_back(small_triangle(glm::dvec3(x * 0.9, 0, 0) + random.in_cube(0.05 * x), 0.01 * x, random));
  return triangles;
}

std::vector<Corners> collinear_points(std::size_t n) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const packed_float3 p = packed({-1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(n), 0.0, 0.0});
    triangles.push_back({p, p, p});
  }
  return triangles;
}

// Rays along the row of triangles, through all boxes at once, and at single triangles.
std::vector<Ray> probing_rays(const std::vector<Corners>& triangles, std::size_t count, Random& random) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Corners& c = triangles[random.below(static_cast<uint>(triangles.size()))];
    const glm::dvec3 at = 0.4 * unpacked(c[0]) + 0.3 * unpacked(c[1]) + 0.3 * unpacked(c[2]);
    if (i % 3 == 0) rays.push_back(ray_towards(random.in_cube(), at));
    if (i % 3 == 1) rays.push_back(ray_towards({random.sign(), at.y, at.z}, at));
    if (i % 3 == 2) rays.push_back(ray_towards({-0.99, 1e-7 * random.unit(), 1e-7 * random.unit()}, {1, 0, 0}));
  }
  return rays;
}

// Bits of the children whose boxes the ray meets: a twin of node_intersect (cl/traverse.h), operation for operation.
template <int W>
unsigned boxes_met(const BvhNode<W>& node, const Ray& ray) {
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z}, d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  unsigned mask = 0;
  for (int lane = 0; lane < W; ++lane) {
    float near = 0.0f, far = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const float reciprocal = 1.0f / std::copysign(std::max(std::abs(d[axis]), 0x1p-40f), d[axis]);
      const float offset = -o[axis] * reciprocal;
      const int first = 2 * axis + (d[axis] < 0.0f);
      near = std::max(near, std::fma(node.bounds[first][lane], reciprocal, offset));
      far = std::min(far, std::fma(node.bounds[first ^ 1][lane], reciprocal, offset));
    }
    mask |= static_cast<unsigned>(near <= far) << lane;
  }
  return mask;
}

// Most entries that the stack holds below this node, if at each one the child is taken first that needs the most, and nothing
// is dropped: no traversal needs more, closest or any.
template <int W>
int entries_needed(const BvhNode<W>* nodes, uint node, const Ray& ray) {
  const unsigned mask = boxes_met(nodes[node], ray);
  int below = 0;
  for (int lane = 0; lane < W; ++lane) {
    const uint child = nodes[node].child[lane];
    if ((mask >> lane & 1u) && !(child & LEAF_BIT)) below = std::max(below, entries_needed(nodes, child, ray));
  }
  return std::max(0, std::popcount(mask) - 1) + below;
}

int entries_needed(const Bvh& bvh, const Ray& ray) {
  return bvh.width == 4 ? entries_needed(reinterpret_cast<const BvhNode<4>*>(bvh.nodes.data()), 0, ray)
                        : entries_needed(reinterpret_cast<const BvhNode<8>*>(bvh.nodes.data()), 0, ray);
}

// Returns the largest share that a ray needs of the entries that the contract names.
double tree_stands(const std::vector<Corners>& triangles, std::size_t ray_count) {
  double worst = 0.0;
  const Scene scene = scene_of(triangles);
  Random random(9);
  const std::vector<Ray> rays = probing_rays(triangles, ray_count, random);
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    const int exact = (width - 1) * bvh.depth + 1;
    EXPECT_GE(bvh.stack_size(), exact);
    for (std::size_t i = 0; i < std::min<std::size_t>(rays.size(), 15); ++i)
      worst = std::max(worst, static_cast<double>(entries_needed(bvh, rays[i])) / exact);
    const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(disagreement(scene, rays[i], hits[i]), "") << width << " " << i;
    // With the very number of entries that the contract names, and with many more: not a bit differs.
    const std::vector<Hit> tight = trace_closest(scene, bvh, rays, exact), wide = trace_closest(scene, bvh, rays, 8192);
    const std::vector<cl_uint> blocked = trace_any(scene, bvh, rays, exact);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(std::memcmp(&tight[i], &hits[i], sizeof(Hit)), 0) << i;
      EXPECT_EQ(std::memcmp(&wide[i], &hits[i], sizeof(Hit)), 0) << i;
      EXPECT_EQ(blocked[i] != 0, hits[i].primitive != NONE) << i;
    }
  }
  return worst;
}

}  // namespace

TEST(tree_test, stands_for_uniformly_random_triangles) {
  Random random(1);
  record_extreme("X17", tree_stands(uniform(count_or_small(100000, 200), random), count_or_small(150, 9)), 1);
}

TEST(tree_test, stands_for_one_triangle_many_times) {
  Random random(2);
  record_extreme("X17", tree_stands(duplicates(count_or_small(100000, 200), random), count_or_small(150, 9)), 1);
}

TEST(tree_test, stands_for_geometric_progressions) {
  Random random(3);
  const double halves = tree_stands(geometric(count_or_small(120, 60), 0.5, random), count_or_small(3000, 9));
  const double elevenths = tree_stands(geometric(count_or_small(800, 60), 1 / 1.1, random), count_or_small(3000, 9));
  record_extreme("X17", std::max(halves, elevenths), 1);
}

TEST(tree_test, stands_for_clusters_in_geometric_progression) {
  Random random(4);
  record_extreme("X17", tree_stands(clusters(120, count_or_small(1000, 5), random), count_or_small(150, 9)), 1);
}

TEST(tree_test, stands_for_collinear_triangles_without_extent) {
  record_extreme("X17", tree_stands(collinear_points(count_or_small(100000, 500)), count_or_small(150, 9)), 1);
}
