// node_intersect, the conservative box test, against long double on the same floats (extremes X7, X8).
#include <bit>

#include "../host/bvh.h"
#include "box_oracle.h"
#include "extremes.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

template <int W>
struct Answer {
  std::vector<cl_uint> mask;
  std::vector<float> near;
};

template <int W>
Answer<W> intersect(const std::vector<BvhNode<W>>& nodes, const std::vector<Ray>& rays) {
  Answer<W> answer{std::vector<cl_uint>(rays.size()), std::vector<float>(rays.size() * W)};
  run_with({every_feature, W}, "node_test.cl", "intersect", rays.size(), nodes, rays, out(answer.mask), out(answer.near));
  return answer;
}

template <int W>
void no_box_is_missed(std::uint64_t seed, std::size_t groups) {
  Random random(seed);
  std::vector<BvhNode<W>> nodes(groups);
  std::vector<std::array<Box, W>> boxes(groups);
  std::vector<Ray> rays(groups);
  for (std::size_t i = 0; i < groups; ++i) {
    for (int lane = 0; lane < W; ++lane) {
      boxes[i][lane] = random_box(random);
      set_child(nodes[i], lane, boxes[i][lane]);
    }
    rays[i] = random_ray(point_of(boxes[i][random.below(W)], random), random);
    if (random.below(16) == 0) rays[i].t_min = static_cast<float>(random.between(0.0, 2.0));
  }
  const Answer<W> answer = intersect<W>(nodes, rays);
  std::size_t hits = 0, missed = 0, late = 0, false_hits = 0;
  for (std::size_t i = 0; i < groups; ++i) {
    for (int lane = 0; lane < W; ++lane) {
      const Interval exact = exact_slab(boxes[i][lane], rays[i], guaranteed_margin);
      const bool found = answer.mask[i] >> lane & 1u;
      hits += exact.hit();
      missed += exact.hit() && !found;
      late += exact.hit() && answer.near[i * W + lane] > exact.near;
      false_hits += found && !exact_slab(boxes[i][lane], rays[i], 2 * box_padding).hit();
    }
  }
  EXPECT_GT(hits, groups / 2);
  EXPECT_EQ(missed, 0u) << "of " << hits;
  EXPECT_EQ(late, 0u) << "of " << hits;
  EXPECT_EQ(false_hits, 0u) << "further away than two paddings, of " << groups * W;
}

}  // namespace

TEST(node_test, no_box_that_the_exact_ray_hits_is_missed_or_entered_too_late) {
  no_box_is_missed<8>(1, count_or_small(250000, 60));
  no_box_is_missed<4>(2, count_or_small(250000, 60));
  record_law("X7");
}

// Extreme X8.
TEST(node_test, rays_along_the_axes_with_zeros_of_either_sign_hit_exactly_the_boxes_they_meet) {
  const auto [boxes, rays] = axis_cases();
  ASSERT_EQ(rays.size(), 6000u);
  std::vector<BvhNode<8>> nodes(rays.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int lane = 0; lane < 8; ++lane) set_child(nodes[i], lane, boxes[i]);
  const Answer<8> answer = intersect<8>(nodes, rays);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool hit = exact_slab(boxes[i], rays[i], 0.0L).hit();
    hits += hit;
    EXPECT_EQ(answer.mask[i], hit ? 0xffu : 0u) << i;
  }
  EXPECT_GT(hits, 1000u);
  record_law("X8");
}

TEST(node_test, boxes_beyond_t_max_are_not_entered) {
  const Box box{{0.5f, -0.1f, -0.1f}, {0.7f, 0.1f, 0.1f}};
  std::vector<BvhNode<8>> nodes(3);
  for (BvhNode<8>& node : nodes)
    for (int lane = 0; lane < 8; ++lane) set_child(node, lane, box);
  const std::vector<Ray> rays = {{{0, 0, 0}, 0.49f, {1, 0, 0}, NONE, NONE, 0.0f, 0}, {{0, 0, 0}, 0.51f, {1, 0, 0}, NONE, NONE, 0.0f, 0}, {{0, 0, 0}, -0.1f, {1, 0, 0}, NONE, NONE, 0.0f, 0}};
  const Answer<8> answer = intersect<8>(nodes, rays);
  EXPECT_EQ(answer.mask[0], 0u);
  EXPECT_EQ(answer.mask[1], 0xffu);
  EXPECT_EQ(answer.mask[2], 0u);
}

TEST(node_test, empty_children_are_never_hit) {
  Random random(3);
  Scene nothing;
  const Bvh empty = build_bvh(nothing, 8);
  ASSERT_EQ(empty.node_count, 1u);
  std::vector<BvhNode<8>> nodes(count_or_small(20000, 100), *reinterpret_cast<const BvhNode<8>*>(empty.nodes.data()));
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < nodes.size(); ++i) rays.push_back(random_ray(random.in_cube(1.0), random));
  for (const cl_uint mask : intersect<8>(nodes, rays).mask) ASSERT_EQ(mask, 0u);
}

TEST(node_test, lane_masks_are_packed_and_searched_with_x86_instructions_and_without) {
  for (const int width : {4, 8}) {
    std::vector<cl_int> lanes;
    std::vector<cl_uint> patterns(std::size_t{1} << width);
    for (std::size_t i = 0; i < patterns.size(); ++i)
      for (int lane = 0; lane < width; ++lane) lanes.push_back(i >> lane & 1u ? -1 : 0);
    for (const char* file : {"node_test.cl", "node_portable.cl"}) {
      std::vector<cl_uint> lowest(patterns.size());
      run_with({every_feature, width}, file, "pack", patterns.size(), lanes, out(patterns), out(lowest));
      for (std::size_t i = 0; i < patterns.size(); ++i) {
        EXPECT_EQ(patterns[i], i) << file;
        EXPECT_EQ(lowest[i], i == 0 ? static_cast<cl_uint>(width) : static_cast<cl_uint>(std::countr_zero(i))) << file;
      }
    }
  }
}
