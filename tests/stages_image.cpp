// The stages as kernels of their own (cl/stages.cl) against the megakernel (cl/path.cl).
#include <cstring>

#include "textured.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// One of everything that a stage can branch on: diffuse, mirror, glass; triangles and a sphere; an area light, a point light; a blend
// with a mask in it, a masked sheet, a normal map.
World mixed_world() {
  World world;
  add_box(add_shape(world, diffuse(0.7), Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  add_quad(add_shape(world, diffuse(0.2), Sides::front, 5.0).mesh, {-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6});
  add_box(add_shape(world, mirror(0.9), Sides::front).mesh, {-0.8, -1, -0.5}, {-0.2, -0.4, 0.1});
  WorldShape& ball = add_shape(world, dielectric(1.5), Sides::both);
  ball.geometry = Geometry::sphere;
  ball.to_world = glm::dmat4(0.4);
  ball.to_world[3] = {0.4, -0.6, 0.2, 1};
  Material screen = diffuse(0.4);
  screen.transparency = 0.6f;
  screen.normal_texture = add_constant(world, normal_color(glm::normalize(glm::dvec3(0.3, 0.1, 0.9))));
  add_quad(add_shape(world, screen, Sides::both).mesh, {-0.9, 0.3, -0.9}, {1.5, 0, 0}, {0, 0.1, 1.5});
  Material blend{};
  blend.kind = MATERIAL_BLEND;
  blend.weight = 0.5f;
  blend.first = static_cast<uint>(world.materials.size() - 1);
  blend.second = 0;
  add_quad(add_shape(world, blend, Sides::both).mesh, {0.1, -0.8, -0.9}, {0.7, 0, 0}, {0, 0.6, 0.2});
  world.lights.push_back({LIGHT_POINT, glm::dvec3(0.5), {0.5, 0.5, 0.5}});
  world.integrator.moments = true;
  if (small_inputs()) world.integrator.max_depth = 4;
  look(world, {0, 0, 0.9}, {0, -0.2, -1}, {0, 1, 0}, 1.0, static_cast<uint>(count_or_small(37, 4)),
       static_cast<uint>(count_or_small(29, 2)));
  return world;
}

struct Stages {
  const Device& device;
  cl::Program program;
  const std::vector<cl::Buffer>& scene;

  template <class... Arguments>
  void run(const char* name, std::size_t items, const Arguments&... arguments) {
    cl::Kernel kernel(program, name);
    cl_uint index = bind_scene(kernel, scene);
    (kernel.setArg(index++, arguments), ...);
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
  }
};

// The film of both, which must be the same, and no black one.
void expect_same_film(const Scene& scene) {
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const uint samples = static_cast<uint>(count_or_small(REPLICA_SAMPLES + 2, 2));
  Renderer renderer = start_render(device(), scene, bvh);
  render_pass(renderer, samples);
  const Film expected = read_film(renderer);

  Renderer staged = start_render(device(), scene, bvh);
  staged.samples = samples;
  Stages stages{device(), build_program(device(), kernel_directory() / "stages.cl", kernel_options(scene, bvh)), staged.scene};
  const std::size_t items = padded_pixels(scene.settings);
  const auto array = [&](std::size_t bytes) { return cl::Buffer(device().context, CL_MEM_READ_WRITE, items * bytes); };
  const cl::Buffer paths = array(sizeof(PathState)), hits = array(sizeof(Hit)), shadows = array(sizeof(ShadowRay));
  const cl_uint base = 0;
  for (cl_ulong sample = 0; sample < samples; ++sample) {
    stages.run("camera_rays", items, paths, base, sample);
    for (std::vector<PathState> states(items);;) {
      stages.run("closest_hits", items, paths, hits);
      stages.run("shade", items, paths, hits, shadows, base, sample);
      stages.run("shadow_rays", items, paths, shadows, base, sample);
      device().queue.enqueueReadBuffer(paths, CL_TRUE, 0, items * sizeof(PathState), states.data());
      if (std::none_of(states.begin(), states.end(), [](const PathState& p) { return p.alive; })) break;
    }
    stages.run("accumulate", items, paths, staged.film.pixels, staged.film.moments, staged.film.errors, base, sample);
  }
  const Film film = read_film(staged);
  ASSERT_EQ(film.pixels.size(), expected.pixels.size());
  EXPECT_EQ(std::memcmp(film.pixels.data(), expected.pixels.data(), film.pixels.size() * sizeof(FilmPixel)), 0);
  EXPECT_EQ(std::memcmp(film.moments.data(), expected.moments.data(), film.moments.size() * sizeof(FilmMoments)), 0);
  EXPECT_EQ(std::memcmp(film.errors.data(), expected.errors.data(), film.errors.size() * sizeof(FilmErrors)), 0);
  EXPECT_EQ(film.replicas, samples / REPLICA_SAMPLES);
  double total = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) total += pixel_mean(film, i)[0];
  EXPECT_GT(total, 0.0) << "both films are black";
}

}  // namespace

TEST(stages_image, stages_in_a_loop_give_the_megakernels_film_bit_for_bit) { expect_same_film(place_scene(mixed_world())); }

TEST(stages_image, stages_approximate_as_the_megakernel_does) {
  Scene scene = place_scene(mixed_world());
  scene.approximations = APPROXIMATION_SCHLICK | APPROXIMATION_CLAMP | APPROXIMATION_BSDF_SAMPLING;
  scene.settings.largest_sample = 0.3f;
  expect_same_film(scene);
}
