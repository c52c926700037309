// node_intersect, the conservative box test, against long double on the same floats (extremes X7, X8).
#include <bit>

#include "../host/bvh.h"
#include "extremes.h"
#include "kernel.h"
#include "random.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Box {
  packed_float3 low, high;
};

struct Interval {
  long double near, far;
  bool hit() const { return near <= far; }
};

// Where the exact ray runs inside the box moved outwards by `margin` on every side, for t_min <= t <= t_max.
Interval exact_slab(const Box& box, const Ray& ray, long double margin) {
  const float low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z}, d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  Interval result{ray.t_min, ray.t_max};
  for (int axis = 0; axis < 3; ++axis) {
    const long double below = low[axis] - margin - o[axis], above = high[axis] + margin - o[axis];
    if (d[axis] == 0.0f) {
      if (below > 0.0L || above < 0.0L) return {1.0L, 0.0L};
      continue;
    }
    const long double a = below / d[axis], b = above / d[axis];
    result.near = std::max(result.near, std::min(a, b));
    result.far = std::min(result.far, std::max(a, b));
  }
  return result;
}

template <int W>
void set_child(BvhNode<W>& node, int lane, const Box& box) {
  const float low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
  for (int axis = 0; axis < 3; ++axis) {  // as host/bvh.cpp pads
    node.bounds[2 * axis][lane] = low[axis] - box_padding;
    node.bounds[2 * axis + 1][lane] = high[axis] + box_padding;
  }
}

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

// A box in [-1, 1]^3: tiny or large, often flat or thinner than the padding, often touching the frame's side.
Box random_box(Random& random) {
  glm::dvec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = random.below(4) == 0 ? 0.0 : random.log_between(1e-8, 2.0);
    low[axis] = random.below(8) == 0 ? -1.0 : random.between(-1.0, 1.0 - size);
    high[axis] = random.below(8) == 0 ? 1.0 : std::min(1.0, low[axis] + size);
  }
  return {packed(low), packed(high)};
}

// A point of the box: a corner, a point of an edge, of a face, or inside.
glm::dvec3 point_of(const Box& box, Random& random) {
  const glm::dvec3 low = unpacked(box.low), high = unpacked(box.high);
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const double s = random.below(3) == 0 ? random.unit() : static_cast<double>(random.below(2));
    p[axis] = low[axis] + s * (high[axis] - low[axis]);
  }
  return p;
}

Ray random_ray(const glm::dvec3& target, Random& random) {
  glm::dvec3 origin = random.in_cube(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (random.below(8) == 0) origin[axis] = random.sign();
    if (random.below(8) == 0) origin[axis] = target[axis];  // zero or tiny components
    if (random.below(32) == 0) origin[axis] += 1e-9 * random.sign();
  }
  if (origin == target) origin.x = -origin.x + 0.5;
  Ray ray{packed(origin), 1e30f, packed(glm::normalize(target - origin)), NONE, NONE, 0.0f, 0};
  for (float* component : {&ray.direction.x, &ray.direction.y, &ray.direction.z})
    if (*component == 0.0f) *component = random.below(2) ? -0.0f : random.below(2) ? 0.0f : 1e-30f;
  return ray;
}

// The padding is 32 u. The test itself displaces planes by 5 u, rounding low - padding takes 1 u more (coordinates up to 1 +
// 16 u): what comes within 10 u of the box, the displacement of the sheared vertices, must be found, and no later than there.
constexpr long double guaranteed = 10 * unit_roundoff;

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
      const Interval exact = exact_slab(boxes[i][lane], rays[i], guaranteed);
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

// Extreme X8: origins {-1, -.5, 0, .5, 1}^3, six axes, four signs of the two zeros, a box and a flat box: 6000 cases, all exact.
TEST(node_test, rays_along_the_axes_with_zeros_of_either_sign_hit_exactly_the_boxes_they_meet) {
  std::vector<BvhNode<8>> nodes;
  std::vector<Ray> rays;
  std::vector<Box> boxes;
  for (const bool flat : {false, true})
    for (int grid = 0; grid < 125; ++grid)
      for (int way = 0; way < 6; ++way)
        for (int zeros = 0; zeros < 4; ++zeros) {
          float d[3];
          d[way / 2] = way % 2 ? -1.0f : 1.0f;
          d[(way / 2 + 1) % 3] = zeros & 1 ? -0.0f : 0.0f;
          d[(way / 2 + 2) % 3] = zeros & 2 ? -0.0f : 0.0f;
          rays.push_back({{0.5f * (grid % 5 - 2), 0.5f * (grid / 5 % 5 - 2), 0.5f * (grid / 25 - 2)}, 1e30f, {d[0], d[1], d[2]}, NONE, NONE, 0.0f, 0});
          boxes.push_back(flat ? Box{{-0.5f, -0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}} : Box{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}});
          nodes.emplace_back();
          for (int lane = 0; lane < 8; ++lane) set_child(nodes.back(), lane, boxes.back());
        }
  ASSERT_EQ(rays.size(), 6000u);
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
