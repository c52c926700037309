// The structure of the tree that goes to the device.
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

template <int W>
struct Walk {
  const Scene& scene;
  const BvhNode<W>* nodes;
  const TriangleBlock<W>* blocks;
  std::size_t node_count, block_count;
  std::vector<int> triangle_seen, quadric_seen, node_seen, block_seen;
  int depth = 0;

  Walk(const Scene& s, const Bvh& bvh)
      : scene(s), nodes(reinterpret_cast<const BvhNode<W>*>(bvh.nodes.data())), blocks(reinterpret_cast<const TriangleBlock<W>*>(bvh.blocks.data())),
        node_count(bvh.nodes.size() / sizeof(BvhNode<W>)), block_count(bvh.blocks.size() / sizeof(TriangleBlock<W>)),
        triangle_seen(s.triangles.size()), quadric_seen(s.quadrics.size()), node_seen(node_count), block_seen(block_count) {
    EXPECT_EQ(node_count, bvh.node_count);
    EXPECT_EQ(block_count, bvh.block_count);
    node(0, 1);
  }

  using Box = std::array<float, 6>;  // as rows of a node
  static void join(Box& box, const glm::dvec3& low, const glm::dvec3& high) {
    for (int k = 0; k < 3; ++k) {
      box[2 * k] = std::min(box[2 * k], static_cast<float>(low[k]));
      box[2 * k + 1] = std::max(box[2 * k + 1], static_cast<float>(high[k]));
    }
  }

  // Returns the exact box of what lies below, and checks that every child's box holds it with the padding.
  Box node(std::size_t index, int level) {
    Box all{1e30f, -1e30f, 1e30f, -1e30f, 1e30f, -1e30f};
    EXPECT_LT(index, node_count);
    ++node_seen[index];
    depth = std::max(depth, level);
    for (int i = 0; i < W; ++i) {
      const uint child = nodes[index].child[i];
      if (child == NONE) {
        for (int row = 0; row < 6; ++row) EXPECT_EQ(nodes[index].bounds[row][i], row % 2 ? -1e30f : 1e30f);
        continue;
      }
      const Box box = child & LEAF_BIT ? leaf(child) : node(child, level + 1);
      for (int k = 0; k < 3; ++k) {
        // Rounding of bound - padding: u; Embree may widen, not narrow.
        EXPECT_LE(nodes[index].bounds[2 * k][i], box[2 * k] - box_padding + unit_roundoff);
        EXPECT_GE(nodes[index].bounds[2 * k + 1][i], box[2 * k + 1] + box_padding - unit_roundoff);
        EXPECT_GE(nodes[index].bounds[2 * k][i], box[2 * k] - 2 * box_padding);
        EXPECT_LE(nodes[index].bounds[2 * k + 1][i], box[2 * k + 1] + 2 * box_padding);
        all[2 * k] = std::min(all[2 * k], box[2 * k]);
        all[2 * k + 1] = std::max(all[2 * k + 1], box[2 * k + 1]);
      }
    }
    return all;
  }

  Box leaf(uint child) {
    Box box{1e30f, -1e30f, 1e30f, -1e30f, 1e30f, -1e30f};
    const uint count = (child & ~LEAF_BIT) >> LEAF_COUNT_SHIFT, first = child & LEAF_INDEX_MASK;
    if (count == 0) {
      ++quadric_seen.at(first);
      const Quadric& q = scene.quadrics[first];
      glm::dmat4 map(1.0);
      const packed_float3* axes[3] = {&q.axis_x, &q.axis_y, &q.axis_z};
      for (int c = 0; c < 3; ++c) map[c] = glm::dvec4(unpacked(*axes[c]) / glm::dot(unpacked(*axes[c]), unpacked(*axes[c])), 0);
      map[3] = glm::dvec4(unpacked(q.center), 1);
      const Bounds exact = quadric_bounds(q.kind == QUADRIC_SPHERE ? Geometry::sphere : q.kind == QUADRIC_DISK ? Geometry::disk : Geometry::cylinder, map);
      join(box, exact.low, exact.high);
      return box;
    }
    std::vector<uint> in_leaf;
    for (uint b = first; b < first + count; ++b) {
      ++block_seen.at(b);
      for (int lane = 0; lane < W; ++lane) {
        const uint primitive = blocks[b].primitive[lane];
        const Corners c = corners_of(scene, primitive);
        for (int v = 0; v < 3; ++v) {
          EXPECT_EQ(blocks[b].vertex[v][0][lane], c[v].x);
          EXPECT_EQ(blocks[b].vertex[v][1][lane], c[v].y);
          EXPECT_EQ(blocks[b].vertex[v][2][lane], c[v].z);
          join(box, unpacked(c[v]), unpacked(c[v]));
        }
        // Unused lanes repeat the last triangle.
        if (std::find(in_leaf.begin(), in_leaf.end(), primitive) == in_leaf.end()) {
          ++triangle_seen.at(primitive);
          in_leaf.push_back(primitive);
        } else {
          EXPECT_EQ(primitive, in_leaf.back());
        }
      }
    }
    return box;
  }
};

template <int W>
void expect_whole(const Scene& scene) {
  const Bvh bvh = build_bvh(scene, W);
  const Walk<W> walk(scene, bvh);
  for (const auto* seen : {&walk.triangle_seen, &walk.quadric_seen, &walk.node_seen, &walk.block_seen})
    EXPECT_EQ(std::count(seen->begin(), seen->end(), 1), static_cast<std::ptrdiff_t>(seen->size()));
  EXPECT_EQ(walk.depth, bvh.depth);
  EXPECT_EQ(bvh.width, W);
  EXPECT_GE(bvh.stack_size(), (W - 1) * bvh.depth + 1);
  EXPECT_EQ(bvh.stack_size() & (bvh.stack_size() - 1), 0);
  EXPECT_GE(bvh.stack_size(), 64);
}

World with_quadrics(std::size_t count, bool mesh) {
  Random random(4);
  World world;
  if (mesh) add_shape(world, diffuse(0.5), Sides::both).mesh = icosphere(3, 0.1, 3);
  for (std::size_t i = 0; i < count; ++i) {
    WorldShape& shape = add_shape(world, diffuse(0.5), Sides::both);
    shape.geometry = i % 3 == 0 ? Geometry::sphere : i % 3 == 1 ? Geometry::disk : Geometry::cylinder;
    const double r = random.log_between(1e-3, 0.5);
    const glm::dvec3 z = random.direction(), x = glm::normalize(glm::cross(random.direction(), z)), y = glm::cross(z, x);
    shape.to_world = glm::dmat4(glm::dvec4(r * x, 0), glm::dvec4(r * y, 0), glm::dvec4(r * z, 0), glm::dvec4(random.in_cube(), 1));
  }
  return world;
}

}  // namespace

TEST(bvh_test, every_primitive_lies_in_one_leaf_below_boxes_that_hold_it_with_the_padding) {
  for (const World& world : {world_of(icosphere(4, 0.1, 3)), with_quadrics(100, false), with_quadrics(100, true), with_quadrics(1, false), with_quadrics(1, true)}) {
    const Scene scene = place_scene(world);
    expect_whole<4>(scene);
    expect_whole<8>(scene);
  }
}

TEST(bvh_test, scenes_of_no_and_of_few_triangles_have_a_root) {
  Random random(5);
  for (std::size_t n : {0u, 1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 16u, 17u, 33u, 64u}) {
    std::vector<Corners> triangles(n);
    for (Corners& c : triangles)
      for (packed_float3& v : c) v = packed(random.in_cube());
    expect_whole<4>(scene_of(triangles));
    expect_whole<8>(scene_of(triangles));
  }
}

// Triangles and quadrics together: what is nearest is hit, whichever tree it is in.
TEST(bvh_test, the_nearest_of_triangles_and_quadrics_is_hit) {
  World world = with_quadrics(0, true);
  WorldShape& ball = add_shape(world, diffuse(0.5), Sides::both);
  ball.geometry = Geometry::sphere;
  ball.to_world = glm::dmat4(glm::dvec4(0.25, 0, 0, 0), glm::dvec4(0, 0.25, 0, 0), glm::dvec4(0, 0, 0.25, 0), glm::dvec4(0, 0, 0, 1));
  const Scene scene = place_scene(world);
  const glm::dvec3 center = unpacked(scene.quadrics[0].center);
  const double r = 1.0 / glm::length(unpacked(scene.quadrics[0].axis_x));
  Random random(6);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count_or_small(5000, 20); ++i) {
    const glm::dvec3 side = random.direction();
    rays.push_back(ray_towards(center + (i % 2 ? 2.0 : 0.9) * side, center));  // from between ball and mesh, and from outside both
    if (i % 2 == 0) rays.back() = ray_towards(center + 1.2 * r * side, center);
    if (i % 3 == 0) rays.back().direction = packed(-unpacked(rays.back().direction));
  }
  for (const int width : {4, 8}) {
    const std::vector<Hit> hits = trace_closest(scene, build_bvh(scene, width), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool outside = i % 2, away = i % 3 == 0;
      const uint id = hits[i].primitive;
      EXPECT_TRUE(outside && away ? id == NONE : !outside && !away ? id == QUADRIC_BIT : id < scene.triangles.size()) << i;
    }
  }
}
