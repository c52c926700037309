// Spot lights: the falloff against long double and against values measured in Mitsuba, the flux against quadrature.
#include "extremes.h"
#include "lights.h"
#include "quadrature.h"

using namespace oclair;
using namespace oclair::test;

namespace {

const double pi = std::acos(-1.0);

World spot_world(double cutoff, double beam, const glm::dvec3& axis, const glm::dvec3& position = {0, 0, 0}) {
  World world;
  add_frame_box(world);
  WorldLight& light = world.lights.emplace_back();
  light.kind = LIGHT_SPOT;
  light.value = glm::dvec3(4.0, 2.0, 1.0);
  light.position = position;
  light.axis = glm::normalize(axis);
  light.cutoff_angle = cutoff;
  light.beam_width = beam;
  return world;
}

// Angles in radians, all as the device has them.
long double falloff(const Light& light, const glm::dvec3& d) {
  const glm::dvec3 axis = unpacked(light.edge1);
  const glm::dvec3 c = glm::cross(axis, d);
  const long double angle = std::atan2(static_cast<long double>(glm::length(c)), static_cast<long double>(glm::dot(axis, d)));
  const long double cutoff = light.edge2.x, beam = light.edge2.y;
  return angle <= beam ? 1.0L : angle < cutoff ? (cutoff - angle) / (cutoff - beam) : 0.0L;
}

}  // namespace

// The cross product errs by 2 u, the arc tangent by 6 ulp: the angle by 4 u + 12 u of itself. The falloff by that over the width of its
// ramp, and by 3 roundings.
TEST(spot_test, the_falloff_is_linear_in_the_angle_between_beam_and_cutoff) {
  Random random(1);
  std::vector<Light> lights;
  std::vector<packed_float3> directions;
  for (const auto& [cutoff, beam] : {std::pair(20.0, 15.0), {60.0, 10.0}, {90.0, 0.0}, {179.0, 90.0}, {180.0, 135.0}, {1.0, 0.75}, {0.01, 0.001}}) {
    const Scene scene = place_scene(spot_world(cutoff, beam, random.direction()));
    ASSERT_EQ(scene.lights.size(), 1u);
    const glm::dvec3 z = unpacked(scene.lights[0].edge1), x = glm::normalize(glm::cross(z, glm::dvec3(0.3, 0.5, 0.8))), y = glm::cross(z, x);
    for (std::size_t i = 0; i < count_or_small(2000, 10); ++i) {
      const double angle = glm::radians(std::min(180.0, random.between(0.0, 1.3) * cutoff)), phi = random.between(0, 2 * pi);
      directions.push_back(packed(std::sin(angle) * (std::cos(phi) * x + std::sin(phi) * y) + std::cos(angle) * z));
      lights.push_back(scene.lights[0]);
    }
  }
  std::vector<float> share(directions.size());
  run("light_test.cl", "falloff", directions.size(), lights, directions, out(share));
  std::array<std::size_t, 3> met{};
  double worst = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double exact = static_cast<double>(falloff(lights[i], unpacked(directions[i])));
    const double ramp = static_cast<double>(lights[i].edge2.x) - lights[i].edge2.y;
    const double bound = (4 + 12 * lights[i].edge2.x) * unit_roundoff / ramp + 3 * unit_roundoff;
    const double off = std::abs(share[i] - exact);
    EXPECT_LE(off, bound) << i;
    worst = std::max(worst, off / bound);
    ++met[exact == 0.0 ? 0 : exact == 1.0 ? 1 : 2];
  }
  for (const std::size_t m : met) EXPECT_GT(m, count_or_small(1000, 1));
  record_extreme("X19", worst, 1);
}

// Beam and cutoff alike: an edge. On the axis all, behind nothing.
TEST(spot_test, a_beam_as_wide_as_the_cutoff_is_cut_sharply) {
  const Scene scene = place_scene(spot_world(40.0, 40.0, {0, 0, 1}));
  std::vector<packed_float3> directions;
  for (const double degrees : {0.0, 39.999, 40.001, 90.0, 180.0}) directions.push_back(packed({std::sin(glm::radians(degrees)), 0, std::cos(glm::radians(degrees))}));
  std::vector<float> share(directions.size());
  run("light_test.cl", "falloff", directions.size(), std::vector<Light>(directions.size(), scene.lights[0]), directions, out(share));
  EXPECT_EQ(share, (std::vector<float>{1, 1, 0, 0, 0}));
}

// Measured in Mitsuba 3.9.1: falloff at angles from the axis, at distance 2.
TEST(spot_test, a_spot_sends_what_it_sends_in_mitsuba) {
  struct Row {
    double cutoff, beam, angle, share;
  };
  for (const Row& row : {Row{20, 15, 5, 1}, {20, 15, 15.01, .9979997}, {20, 15, 18.75, .24999931}, {20, 15, 20.01, 0}, {60, 10, 35, .5},
                         {60, 10, 47.5, .25000006}, {100, 50, 90, .19999997}, {180, 135, 150, .66666675}}) {
    const glm::dvec3 axis(0, 0, 1), at(std::sin(glm::radians(row.angle)), 0, std::cos(glm::radians(row.angle)));
    World world = spot_world(row.cutoff, row.beam, axis);
    const Scene scene = place_scene(world);
    const LightResult s = sample_light(scene, 0, 0.25 * at, {{0.5f, 0.5f}})[0];  // 1/2 in the world, which the frame halves
    // d^2 = 1/4; the angle of the point, rounded to float32, is known to u.
    EXPECT_NEAR(s.weight.x, 16.0 * row.share, 16.0 * 4e-6) << row.cutoff << " " << row.angle;
    EXPECT_NEAR(s.weight.z, 4.0 * row.share, 4.0 * 4e-6);
    EXPECT_LE(glm::length(unpacked(s.direction) + at), 6 * unit_roundoff);
    EXPECT_EQ(s.pdf, 0.0f);
    EXPECT_EQ(s.primitive, NONE);
    EXPECT_NEAR(s.distance, 0.25, 4 * unit_roundoff);
  }
}

TEST(spot_test, a_spot_is_chosen_by_the_flux_of_its_cone) {
  for (const auto& [cutoff, beam] : {std::pair(20.0, 15.0), {90.0, 0.0}, {180.0, 135.0}, {30.0, 30.0}, {5.0, 4.999999999999999}, {45.0, 44.99999}}) {
    World world = spot_world(cutoff, beam, {0, 1, 0});
    world.lights.push_back({LIGHT_POINT, glm::dvec3(4.0, 2.0, 1.0), {0.1, 0, 0}});
    double solid_angle = 0;
    for (const auto& [low, high] : {std::pair(0.0, beam), {beam, cutoff}})
      for (const Node& node : gauss_legendre(40, glm::radians(low), glm::radians(high)))
        solid_angle += node.weight * 2 * pi * std::sin(node.x) * (low == 0.0 && high == beam ? 1.0 : (glm::radians(cutoff) - node.x) / glm::radians(cutoff - beam + (cutoff == beam)));
    const Scene scene = place_scene(world);
    EXPECT_NEAR(scene.lights[0].probability, solid_angle / (solid_angle + 4 * pi), 1e-6) << cutoff;
  }
}
