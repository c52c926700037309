// Closed rooms and other renders whose radiance is known exactly (integrating spheres; extremes X29, X31).
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

World furnace(double albedo, uint max_depth) {
  World world;
  WorldShape& room = add_shape(world, diffuse(albedo), Sides::front, 1.0);
  add_box(room.mesh, {-1, -1, -1}, {1, 1, 1}, true);
  look(world, {0.1, 0.2, 0.3}, {1, 0.5, 0.2}, {0, 1, 0}, 1.0, 16, 16);
  world.integrator.max_depth = max_depth;
  return world;
}

}  // namespace

// L = Le (1 - albedo^N) / (1 - albedo) after N segments.
TEST(furnace_image, closed_room_truncated_at_depth_n_is_the_geometric_sum) {
  for (const uint depth : {1u, 2u, 5u, 17u}) {
    const Estimate e = image_mean(render(furnace(0.8, depth), 256));
    const double exact = (1.0 - std::pow(0.8, depth)) / 0.2;
    EXPECT_NEAR(e.mean, exact, 4.3 * e.error + 1e-6 * exact) << depth;
  }
}
