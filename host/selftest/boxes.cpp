#include "box_oracle.h"
#include "groups.h"

namespace oclair::selftest {
namespace {

template <int WIDTH>
struct Cases {
  std::vector<BvhNode<WIDTH>> nodes;
  std::vector<std::array<Box, WIDTH>> boxes;
  std::vector<Ray> rays;
};

// Rays aimed at corners, edges, faces and insides of boxes of all sizes, with components that are 0, -0 or tiny.
template <int WIDTH>
Cases<WIDTH> random_cases() {
  Random random(11);
  Cases<WIDTH> cases{std::vector<BvhNode<WIDTH>>(many), std::vector<std::array<Box, WIDTH>>(many), {}};
  for (std::size_t i = 0; i < many; ++i) {
    for (int lane = 0; lane < WIDTH; ++lane) {
      cases.boxes[i][lane] = random_box(random);
      set_child(cases.nodes[i], lane, cases.boxes[i][lane]);
    }
    cases.rays.push_back(random_ray(point_of(cases.boxes[i][random.below(WIDTH)], random), random));
    if (random.below(16) == 0) cases.rays.back().t_min = static_cast<float>(random.between(0.0, 2.0));
  }
  return cases;
}

template <int WIDTH>
struct Answer {
  std::vector<cl_uint> mask;
  std::vector<float> near;
};

template <int WIDTH>
Answer<WIDTH> intersect(const Session& session, const std::vector<BvhNode<WIDTH>>& nodes, const std::vector<Ray>& rays) {
  Answer<WIDTH> answer{std::vector<cl_uint>(rays.size()), std::vector<float>(rays.size() * WIDTH)};
  run(session, "boxes", rays.size(), nodes, rays, out(answer.mask), out(answer.near));
  return answer;
}

template <int WIDTH>
void check_width(const Session& session, Group& group) {
  const Cases<WIDTH> cases = random_cases<WIDTH>();
  const Answer<WIDTH> answer = intersect<WIDTH>(session, cases.nodes, cases.rays);
  std::size_t hits = 0, missed = 0, late = 0, far_off = 0;
  for (std::size_t i = 0; i < many; ++i)
    for (int lane = 0; lane < WIDTH; ++lane) {
      const Interval exact = exact_slab(cases.boxes[i][lane], cases.rays[i], guaranteed_margin);
      const bool found = answer.mask[i] >> lane & 1u;
      hits += exact.hit();
      missed += exact.hit() && !found;
      late += exact.hit() && found && !(answer.near[i * WIDTH + lane] <= exact.near);
      far_off += found && !exact_slab(cases.boxes[i][lane], cases.rays[i], 2 * box_padding).hit();
    }

  const AxisCases axes = axis_cases();
  std::vector<BvhNode<WIDTH>> nodes(axes.rays.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int lane = 0; lane < WIDTH; ++lane) set_child(nodes[i], lane, axes.boxes[i]);
  const Answer<WIDTH> along = intersect<WIDTH>(session, nodes, axes.rays);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    wrong += along.mask[i] != (exact_slab(axes.boxes[i], axes.rays[i], 0.0L).hit() ? (1u << WIDTH) - 1u : 0u);

  group.measure("boxes", static_cast<double>(many * WIDTH));
  group.measure("hit", static_cast<double>(hits));
  group.bound("missed", static_cast<double>(missed), 0);
  group.bound("entered too late", static_cast<double>(late), 0);
  group.bound("found beyond twice the padding", static_cast<double>(far_off), 0);
  group.bound("wrong along axes", static_cast<double>(wrong), 0);
}

}  // namespace

// No box that the exact ray comes within 10 u of is missed or entered too late, and none is found that it passes at more
// than twice the padding. Rays along the axes, with zeros of either sign, find exactly the boxes that they meet.
void check_boxes(const Session& session, Group& group) {
  if (session.device.bvh_width == 4)
    check_width<4>(session, group);
  else
    check_width<8>(session, group);
}

}  // namespace oclair::selftest
