// Parts of a render, each a renderer of its own, against the render of all samples at once: the same bits.
#include "checkpoint_cases.h"
#include "temporary_directory.h"
#include "worlds.h"

namespace {

using namespace oclair;
using namespace oclair::test;

// Colours, light that is found in several ways, and second moments.
World room() {
  World world;
  look(world, {0, 0, -0.9}, {0, 0, 0}, {0, 1, 0}, 1.0, 11, 9);
  world.film.filter = FilterKind::gaussian;
  world.film.filter_radius = 2.0;
  world.integrator.moments = true;
  world.integrator.moment_name = "m";
  add_box(add_shape(world, diffuse(0.7), Sides::both).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  add_quad(add_shape(world, diffuse(0.2), Sides::front, 5.0).mesh, {-0.3, 0.9, -0.3}, {0.6, 0, 0}, {0, 0, 0.6});
  return world;
}

class Parts {
 public:
  Parts() : world_(room()), scene_(place_scene(world_)), bvh_(build_bvh(scene_, device().bvh_width)) {}

  // Of the passes, in this order.
  Checkpoint render(std::uint64_t first, const std::vector<uint>& passes) const {
    Renderer renderer = start_render(device(), scene_, bvh_);
    renderer.first_sample = first;
    for (const uint samples : passes) render_pass(renderer, samples);
    return checkpoint_of(renderer);
  }

  // From a checkpoint of one range.
  Checkpoint go_on(const Checkpoint& checkpoint, const std::vector<uint>& passes) const {
    Renderer renderer = start_render(device(), scene_, bvh_);
    renderer.first_sample = checkpoint.ranges.front().first;
    restore_film(renderer, checkpoint.film);
    for (const uint samples : passes) render_pass(renderer, samples);
    return checkpoint_of(renderer);
  }

 private:
  Checkpoint checkpoint_of(const Renderer& renderer) const {
    Checkpoint checkpoint;
    checkpoint.identity = {{"seed", "0"}};
    checkpoint.ranges = {{renderer.first_sample, renderer.samples}};
    checkpoint.film = read_film(renderer);
    checkpoint.head.film = world_.film;
    return checkpoint;
  }

  World world_;
  Scene scene_;
  Bvh bvh_;
};

TEST(merge_image, parts_are_the_single_render_bit_for_bit) {
  const Parts parts;
  const Checkpoint whole = parts.render(0, {84});
  EXPECT_GT(pixel_mean(whole.film, 5)[0], 0.0);
  EXPECT_TRUE(pixel_standard_error(whole.film, 5).has_value());
  const Checkpoint a = parts.render(0, {5, 11}), b = parts.render(16, {1, 1, 2, 28}), c = parts.render(48, {36});
  expect_same(merge({a, b, c}), whole);
  expect_same(merge({c, merge({b, a})}), whole);
}

TEST(merge_image, a_render_that_goes_on_from_its_file_is_the_single_render_bit_for_bit) {
  const TemporaryDirectory directory;
  const Parts parts;
  const Checkpoint whole = parts.render(16, {60});
  Checkpoint part = parts.render(16, {7});  // within a replica
  for (const uint samples : {1u, 9u, 20u, 23u}) {
    write_checkpoint(directory / "a", part);
    part = parts.go_on(read_checkpoint(directory / "a"), {samples});
  }
  expect_same(part, whole);
}

}  // namespace
