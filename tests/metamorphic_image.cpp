// Laws between renders, bit for bit: what must not change the film at all, or by an exact power of two.
#include <cstring>
#include <limits>

#include "../host/error.h"
#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// One of everything. Coordinates are multiples of 2^-10, so that they can be moved by integers without rounding.
World zoo(uint width = 44, uint height = 37) {
  World world;
  add_box(add_shape(world, diffuse(0.7), Sides::front).mesh, {-1, -1, -1.5}, {1, 1, 1}, true);
  add_quad(add_shape(world, diffuse(0.2), Sides::front, 5.0).mesh, {-0.25, 0.9375, -0.25}, {0.5, 0, 0}, {0, 0, 0.5});
  add_box(add_shape(world, mirror(0.9), Sides::both).mesh, {-0.75, -1, -0.5}, {-0.25, -0.5, 0});
  Material gold = diffuse(1.0);
  gold.kind = MATERIAL_CONDUCTOR;
  gold.conductor_eta = {0.155f, 0.42f, 1.47f};
  gold.conductor_k = {3.6f, 2.35f, 1.77f};
  const auto quadric = [&](const Material& material, Geometry geometry, glm::dvec3 scale, glm::dvec3 base, double radiance) {
    WorldShape& shape = add_shape(world, material, Sides::both, radiance);
    shape.geometry = geometry;
    shape.to_world = glm::dmat4(glm::dvec4(scale.x, 0, 0, 0), glm::dvec4(0, scale.y, 0, 0), glm::dvec4(0, 0, scale.z, 0), glm::dvec4(base, 1));
  };
  quadric(dielectric(1.5), Geometry::sphere, glm::dvec3(0.375), {0.375, -0.5, 0.25}, 0);
  quadric(gold, Geometry::cylinder, {0.125, 0.125, 0.5}, {-0.625, 0.25, -0.75}, 0);
  quadric(diffuse(0.5), Geometry::disk, {0.25, 0.25, 1}, {0.5, 0.5, -1}, 0);
  quadric(diffuse(0.1), Geometry::sphere, glm::dvec3(0.0625), {-0.5, 0.5, 0.25}, 20.0);
  quadric(diffuse(0.1), Geometry::disk, {0.125, 0.125, 1}, {0.75, 0.25, -1.25}, 3.0);
  WorldShape& soft = add_shape(world, diffuse(0.6), Sides::both);
  soft.mesh = icosphere(1, 0.0, 1);
  soft.mesh.normals = soft.mesh.positions;
  for (glm::dvec3& p : soft.mesh.positions) p = glm::round((p * 0.25 + glm::dvec3(0.25, -0.25, -0.75)) * 1024.0) / 1024.0;
  add_light(world, LIGHT_POINT, {0.25, 0.5, 0.125}, {0.5, 0.75, 0.5});
  add_light(world, LIGHT_DIRECTIONAL, {0.5, 0.25, 0.25}, glm::normalize(glm::dvec3(1, -2, 0.5)));
  add_light(world, LIGHT_CONSTANT, {0.0625, 0.125, 0.25});
  world.shapes[0].mesh.triangles.pop_back();  // a triangular window to the light outside
  look(world, {0, 0, 0.875}, {0, -0.125, -1}, {0, 1, 0}, 1.0, width, height);
  world.integrator.moments = true;
  world.film.filter = FilterKind::gaussian;
  world.film.filter_radius = 2.0;
  return world;
}

Film render_specialised(const World& world, uint samples, int bvh_width = 0) { return render_scene(place_scene(world), samples, bvh_width); }

bool same_pixel(const FilmPixel& a, const FilmPixel& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

std::size_t different_pixels(const Film& a, const Film& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
    bool same = same_pixel(a.pixels[i], b.pixels[i]) && std::memcmp(&a.errors[i], &b.errors[i], sizeof(FilmErrors)) == 0;
    if (!a.moments.empty() && !b.moments.empty()) same = same && std::memcmp(&a.moments[i], &b.moments[i], sizeof(FilmMoments)) == 0;
    count += !same;
  }
  return count;
}

// A film that is worth comparing: light everywhere, and nothing rejected.
void expect_lit(const Film& film) {
  EXPECT_EQ(rejected_samples(film), 0u);
  EXPECT_GT(estimate(film).mean, 0.1);
}

void scale(World& world, double factor) {
  for (WorldShape& shape : world.shapes) {
    for (glm::dvec3& p : shape.mesh.positions) p *= factor;
    for (int c = 0; c < 4; ++c) shape.to_world[c] *= glm::dvec4(glm::dvec3(factor), 1.0);
  }
  for (WorldLight& light : world.lights)
    if (light.kind == LIGHT_POINT) {
      light.position *= factor;
      light.value *= factor * factor;
    }
  world.camera.to_world[3] *= glm::dvec4(glm::dvec3(factor), 1.0);
  world.camera.near_clip *= factor;
  world.camera.far_clip *= factor;
}

void translate(World& world, glm::dvec3 by) {
  for (WorldShape& shape : world.shapes) {
    for (glm::dvec3& p : shape.mesh.positions) p += by;
    shape.to_world[3] += glm::dvec4(by, 0.0);
  }
  for (WorldLight& light : world.lights)
    if (light.kind == LIGHT_POINT) light.position += by;
  world.camera.to_world[3] += glm::dvec4(by, 0.0);
}

// One number for a film, to compare across processes.
std::uint64_t hash(const Film& film) {
  std::uint64_t h = 0xcbf29ce484222325u;
  const auto* bytes = reinterpret_cast<const unsigned char*>(film.pixels.data());
  for (std::size_t i = 0; i < film.pixels.size() * sizeof(FilmPixel); ++i) h = (h ^ bytes[i]) * 0x100000001b3u;
  return h;
}

std::string output_of(const std::string& command) {
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    char line[256];
    while (std::fgets(line, sizeof line, pipe)) text += line;
    if (pclose(pipe) != 0) text += "(failed)";
  }
  return text;
}

}  // namespace

TEST(metamorphic_image, same_render_twice_is_the_same_film_and_another_seed_is_not) {
  World world = zoo();
  const Film film = render_full(world, 8);
  expect_lit(film);
  EXPECT_EQ(different_pixels(film, render_full(world, 8)), 0u);
  world.seed = 1;
  EXPECT_GT(different_pixels(film, render_full(world, 8)), film.pixels.size() / 2);
}

TEST(metamorphic_image, scene_scaled_by_a_power_of_two_is_the_same_film) {
  const Film film = render_full(zoo(), 8);
  for (const int power : {-20, -1, 20}) {
    World world = zoo();
    scale(world, std::ldexp(1.0, power));
    EXPECT_EQ(different_pixels(film, render_full(world, 8)), 0u) << power;
  }
  record_law("X11");
  record_law("X12");
}

// By any other factor only roundings change, which may send single paths elsewhere.
TEST(metamorphic_image, scene_scaled_by_any_factor_is_the_same_within_the_noise) {
  const Estimate a = estimate(render_full(zoo(), 64));
  World world = zoo();
  scale(world, 1.7e-5);
  world.seed = 1;
  const Estimate b = estimate(render_full(world, 64));
  EXPECT_NEAR(a.mean, b.mean, z_limit * std::hypot(a.error, b.error));
}

// All kinds of light at once, to the limits where film and squares still hold them.
TEST(metamorphic_image, emission_scaled_by_a_power_of_two_scales_the_film_exactly) {
  const Film film = render_full(zoo(), 8);
  for (const int power : {-60, -1, 60}) {
    World world = zoo();
    for (WorldShape& shape : world.shapes)
      if (shape.radiance) *shape.radiance *= std::ldexp(1.0, power);
    for (WorldLight& light : world.lights) light.value *= std::ldexp(1.0, power);
    const Film scaled = render_full(world, 8);
    EXPECT_EQ(scaled.exponent, film.exponent + power);
    EXPECT_EQ(different_pixels(film, scaled), 0u) << power;
  }
  record_law("X28");
}

// Where no coordinate is rounded it is the same film; otherwise it is within the noise.
TEST(metamorphic_image, scene_moved_far_away_is_the_same_film) {
  const Film film = render_full(zoo(), 8);
  World world = zoo();
  translate(world, glm::dvec3(1 << 20, -(1 << 18), 3 << 17));
  EXPECT_EQ(different_pixels(film, render_full(world, 8)), 0u);
  world = zoo();
  translate(world, {1e6 / 3, -1e6 / 7, 1e6});
  const Film moved = render_full(world, 8);
  // The paths are the same but for roundings: their noise cancels in the differences of pixels.
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double difference = pixel_mean(moved, i)[0] - pixel_mean(film, i)[0];
    sum += difference;
    squares += difference * difference;
  }
  const double count = static_cast<double>(film.pixels.size()), mean = sum / count;
  const double error = std::sqrt((squares / count - mean * mean) / (count - 1.0));
  record_extreme("X11", mean == 0.0 ? 0.0 : std::abs(mean) / error, sidak_z);
  EXPECT_LT(different_pixels(film, moved), film.pixels.size());
}

TEST(metamorphic_image, any_split_into_passes_is_the_same_film) {
  Scene scene = place_scene(zoo());
  scene.features = every_feature;
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto passes = [&](const std::vector<uint>& samples) {
    Renderer renderer = start_render(device(), scene, bvh);
    for (const uint n : samples) render_pass(renderer, n);
    return read_film(renderer);
  };
  const uint samples = 2 * REPLICA_SAMPLES + 3;
  const Film film = passes({samples});
  EXPECT_EQ(film.samples, samples);
  EXPECT_EQ(film.replicas, 2u);
  EXPECT_EQ(different_pixels(film, passes(std::vector<uint>(samples, 1))), 0u);
  EXPECT_EQ(different_pixels(film, passes({5, 0, 1, samples - 6})), 0u);
  EXPECT_GT(different_pixels(film, passes({samples - 1})), 0u);
  record_law("X32");
}

// Wherever it is stopped: in the middle of a replica too.
TEST(metamorphic_image, film_that_is_read_and_put_back_goes_on_as_if_nothing_had_been) {
  const Scene scene = place_scene(zoo());
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto renderer = [&](std::uint64_t first) {
    Renderer made = start_render(device(), scene, bvh);
    made.first_sample = first;
    return made;
  };
  const std::uint64_t first = 3 * REPLICA_SAMPLES;
  const uint samples = 2 * REPLICA_SAMPLES + 1;
  Renderer undisturbed = renderer(first);
  render_pass(undisturbed, samples);
  for (const uint stop : {0u, 1u, REPLICA_SAMPLES - 1u, REPLICA_SAMPLES + 0u, samples}) {
    Renderer before = renderer(first), after = renderer(first);
    render_pass(before, stop);
    restore_film(after, read_film(before));
    EXPECT_EQ(after.samples, stop);
    render_pass(after, samples - stop);
    EXPECT_EQ(different_pixels(read_film(undisturbed), read_film(after)), 0u) << stop;
  }
}

// 1000 columns and 150 rows at an odd offset of a larger film: bands of 80 rows are two launches each.
TEST(metamorphic_image, film_in_bands_of_several_launches_is_the_film_in_one) {
  World world = zoo();
  world.film.width = 1024, world.film.height = 200;
  world.film.crop_x = 3, world.film.crop_y = 5, world.film.crop_width = 1000, world.film.crop_height = 150;
  world.integrator.moments = false;
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto rendered = [&](std::size_t most_film, uint bands) {
    Renderer renderer = start_render(device(), scene, bvh, {.on_device = most_film});
    EXPECT_EQ(renderer.plan.bands, bands);
    render_pass(renderer, 1);
    return read_film(renderer);
  };
  static_assert(80 * 1000 > max_launch);
  EXPECT_EQ(different_pixels(rendered(1 << 30, 1), rendered(std::size_t{184} * 1000 * 80, 2)), 0u);
  record_law("X32");
}

// 45x37 pixels with moments: 14 760 bytes a row.
TEST(metamorphic_image, film_in_bands_is_the_film_in_one) {
  const Scene scene = place_scene(zoo());
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto rendered = [&](std::size_t most_film, uint bands, std::optional<Film> before) {
    Renderer renderer = start_render(device(), scene, bvh, {.on_device = most_film});
    EXPECT_EQ(renderer.plan.bands, bands);
    if (before) restore_film(renderer, *before);
    for (const uint samples : {3u, REPLICA_SAMPLES + 0u}) render_pass(renderer, samples);
    return read_film(renderer);
  };
  const Film whole = rendered(1 << 30, 1, {});
  for (const auto& [most_film, bands] : {std::pair(14760 * 36, 2u), {14760 * 16, 3u}, {1, 5u}}) {
    const Film film = rendered(most_film, bands, {});
    EXPECT_EQ(different_pixels(whole, film), 0u) << bands;
    EXPECT_EQ(film.rays, whole.rays);
    EXPECT_EQ(different_pixels(rendered(1 << 30, 1, whole), rendered(most_film, bands, film)), 0u) << bands;
  }
}

TEST(metamorphic_image, film_of_another_window_scale_or_without_moments_is_not_put_back) {
  const Scene scene = place_scene(zoo());
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  const Film film = read_film(renderer);
  const auto refusal = [&](auto change) -> std::string {
    Film changed = film;
    change(changed);
    try {
      restore_film(renderer, changed);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::render_failed);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal([](Film&) {}), "");
  EXPECT_NE(refusal([](Film& f) { ++f.width; }).find("film: 45x37 pixels with moments"), std::string::npos);
  EXPECT_NE(refusal([](Film& f) { ++f.exponent; }), "");
  EXPECT_NE(refusal([](Film& f) { f.moments.clear(); }).find("without moments"), std::string::npos);
  EXPECT_NE(refusal([](Film& f) { f.errors.pop_back(); }), "");
  EXPECT_NE(refusal([](Film& f) { f.samples = 2 * REPLICA_SAMPLES, f.replicas = 1; }), "");  // of two ranges that were joined
}

// Every sum of the film: what two machines have rendered, added up as integers.
TEST(metamorphic_image, ranges_of_whole_replicas_add_up_to_the_film_of_both) {
  const Scene scene = place_scene(zoo());
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto range = [&](std::uint64_t first, uint samples) {
    Renderer renderer = start_render(device(), scene, bvh);
    renderer.first_sample = first;
    render_pass(renderer, samples);
    return read_film(renderer);
  };
  const auto add = [](ulong* sum, const ulong* other, int limbs) {
    bool carry = false;
    for (int i = 0; i < limbs; ++i) {
      const ulong before = sum[i];
      sum[i] += other[i] + carry;
      carry = sum[i] < before || (carry && sum[i] == before);
    }
  };
  Film sum = range(0, REPLICA_SAMPLES);
  const Film rest = range(REPLICA_SAMPLES, REPLICA_SAMPLES + 3);
  for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      add(sum.pixels[i].sum[c], rest.pixels[i].sum[c], 2);
      add(sum.errors[i].sum[c], rest.errors[i].sum[c], 2);
      add(sum.errors[i].square[c], rest.errors[i].square[c], 3);
    }
    for (int p = 0; p < 6; ++p) add(sum.moments[i].product[p], rest.moments[i].product[p], 3);
    sum.pixels[i].hits += rest.pixels[i].hits;
    sum.pixels[i].rejected += rest.pixels[i].rejected;
  }
  EXPECT_EQ(different_pixels(range(0, 2 * REPLICA_SAMPLES + 3), sum), 0u);
}

// With sample_border every pixel has its whole filter and a crop repeats the pixels of the whole. Without it, so do the pixels
// whose filter stays inside the crop: with the box filter all of them, otherwise those a radius away from its edges.
TEST(metamorphic_image, crop_repeats_the_pixels_of_the_whole) {
  struct Case { FilterKind filter; double radius; bool border; };
  for (const Case c : {Case{FilterKind::box, 0.5, false}, {FilterKind::box, 0.5, true}, {FilterKind::tent, 1.0, true}, {FilterKind::gaussian, 2.0, true}, {FilterKind::tent, 1.0, false}, {FilterKind::gaussian, 2.0, false}}) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(c.filter) << " " << c.border);
    World world = zoo();
    world.film.filter = c.filter;
    world.film.filter_radius = c.radius;
    world.film.sample_border = c.border;
    const Film whole = render_full(world, 4);
    world.film.crop_x = 5;
    world.film.crop_y = 7;
    world.film.crop_width = 21;
    world.film.crop_height = 11;
    const Film crop = render_full(world, 4);
    ASSERT_EQ(crop.pixels.size(), 21u * 11u);
    const int margin = c.border || c.filter == FilterKind::box ? 0 : static_cast<int>(std::ceil(c.radius - 0.5));
    std::size_t edge_differences = 0;
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 21; ++x) {
        const bool same = same_pixel(crop.pixels[y * 21 + x], whole.pixels[(y + 7) * 44 + x + 5]);
        const bool inside = x >= margin && y >= margin && x < 21 - margin && y < 11 - margin;
        EXPECT_TRUE(same || !inside) << x << " " << y;
        edge_differences += !same && !inside;
      }
    EXPECT_EQ(edge_differences > 0, margin > 0);
  }
}

// One column, and a single pixel, of a picture.
TEST(metamorphic_image, thin_crops_repeat_the_pixels_of_the_whole) {
  World world = zoo();
  world.film.sample_border = true;
  const Film whole = render_full(world, 4);
  struct Case { uint x, y, width, height; };
  for (const Case c : {Case{3, 2, 1, 17}, {2, 3, 17, 1}, {43, 36, 1, 1}, {0, 0, 9, 8}}) {
    world.film.crop_x = c.x;
    world.film.crop_y = c.y;
    world.film.crop_width = c.width;
    world.film.crop_height = c.height;
    const Film crop = render_full(world, 4);
    for (uint y = 0; y < c.height; ++y)
      for (uint x = 0; x < c.width; ++x)
        EXPECT_TRUE(same_pixel(crop.pixels[y * c.width + x], whole.pixels[(y + c.y) * 44 + x + c.x])) << x << " " << y;
  }
  record_law("X48");
}

// A picture of one pixel has the mean of the same view in many.
TEST(metamorphic_image, picture_of_one_pixel_is_the_mean_of_the_view) {
  World world = zoo(32, 32);
  world.film.filter = FilterKind::box;
  world.film.filter_radius = 0.5;
  const Estimate many = estimate(render_full(world, 32));
  World single = zoo(1, 1);
  single.film.filter = FilterKind::box;
  single.film.filter_radius = 0.5;
  single.seed = 5;
  const Film film = render_full(single, 32 * 1024 / 4);
  ASSERT_EQ(film.pixels.size(), 1u);
  const Estimate one = estimate(film);
  record_extreme("X48", std::abs(one.mean - many.mean) / std::hypot(one.error, many.error), z_limit);
}

// Equal distances go to the smaller primitive, so the tree's form has no say.
TEST(metamorphic_image, width_of_the_tree_does_not_change_the_film) {
  Scene scene = place_scene(zoo());
  scene.features = every_feature;
  EXPECT_EQ(different_pixels(render_scene(scene, 8, 4), render_scene(scene, 8, 8)), 0u);
}

// What a kernel is compiled without, a scene without it does not miss.
TEST(metamorphic_image, specialised_kernel_gives_the_film_of_the_full_kernel) {
  World mesh;
  add_box(add_shape(mesh, diffuse(0.7), Sides::front, 0.5).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  look(mesh, {0.1, 0.2, 0.3}, {1, 0.5, 0.2}, {0, 1, 0}, 1.0, 24, 24);
  World ball;
  add_light(ball, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_sphere(ball, dielectric(1.5), Sides::both, {0, 0, 0}, 1.0);
  look(ball, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.5, 24, 24);
  World soft;
  WorldShape& rock = add_shape(soft, diffuse(0.6), Sides::front);
  rock.mesh = icosphere(2, 0.1, 3);
  rock.mesh.normals = rock.mesh.positions;
  for (glm::dvec3& n : rock.mesh.normals) n = glm::normalize(n);
  add_light(soft, LIGHT_DIRECTIONAL, glm::dvec3(1.0), {0, 0, -1});
  look(soft, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.5, 24, 24);
  World lamps;
  add_shape(lamps, mirror(0.9), Sides::both).geometry = Geometry::disk;
  add_shape(lamps, diffuse(0.5), Sides::both, 1.0).geometry = Geometry::cylinder;
  add_light(lamps, LIGHT_POINT, glm::dvec3(1.0), {0, 2, 2});
  look(lamps, {0.4, 2.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.5, 24, 24);
  int number = 0;
  for (const World& world : {zoo(), mesh, ball, soft, lamps}) {
    SCOPED_TRACE(number++);
    const Film specialised = render_specialised(world, 8), full = render_full(world, 8);
    EXPECT_GT(estimate(full).mean, 0.01);
    EXPECT_EQ(different_pixels(specialised, full), 0u);
  }
  record_law("X32");
}

TEST(metamorphic_image, moments_do_not_change_the_film) {
  World world = zoo();
  world.integrator.moments = false;
  const Film film = render_specialised(world, 8);
  EXPECT_TRUE(film.moments.empty());
  EXPECT_EQ(different_pixels(film, render_full(world, 8)), 0u);
}

// Prints a film's hash, for the test below, which runs it in another process.
TEST(metamorphic_image, DISABLED_print_hash) { std::printf("hash %016llx\n", static_cast<unsigned long long>(hash(render_full(zoo(), 8)))); }

// The film's hash in another process, whose environment is set before.
void expect_hash_of_zoo(const std::string& environment) {
  char expected[32];
  std::snprintf(expected, sizeof expected, "hash %016llx", static_cast<unsigned long long>(hash(render_full(zoo(), 8))));
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string text = output_of(environment + " '" + program +
                                     "' --gtest_also_run_disabled_tests --gtest_filter=metamorphic_image.DISABLED_print_hash 2>&1");
  EXPECT_NE(text.find(expected), std::string::npos) << environment << ": " << text;
}

TEST(metamorphic_image, film_does_not_depend_on_the_number_of_threads) {
  for (const std::string threads : {"1", "3"}) expect_hash_of_zoo("POCL_MAX_PTHREAD_COUNT=" + threads);
  record_law("X32");
}

// That PoCL heeds the flag is a law of environment_test, which ctest runs under it too.
TEST(metamorphic_image, film_does_not_depend_on_whether_denormals_are_flushed) {
  expect_hash_of_zoo("POCL_EXTRA_BUILD_FLAGS=-cl-denorms-are-zero");
  record_law("X4");
}

// A second quad in the place of the first, of another material: never seen, by whatever tree and in whatever bands. It has to
// come last, for the random numbers of the rest do not depend on it, and the smaller primitive is hit.
TEST(metamorphic_image, a_surface_in_the_place_of_an_earlier_one_changes_no_bit) {
  const auto doubled = [](bool twice) {
    World world = zoo();
    for (int i = 0; i <= twice; ++i)
      add_quad(add_shape(world, i == 0 ? diffuse(0.9) : mirror(0.3), Sides::both).mesh, {-0.5, -0.75, 0.125}, {0.75, 0, 0},
               {0, 0.625, 0.25});
    return world;
  };
  const Film once = render_full(doubled(false), 8);
  expect_lit(once);
  EXPECT_GT(different_pixels(once, render_full(zoo(), 8)), once.pixels.size() / 2);
  Scene scene = place_scene(doubled(true));
  scene.features = every_feature;
  for (const int width : {4, 8}) {
    EXPECT_EQ(different_pixels(once, render_scene(scene, 8, width)), 0u) << width;
    const Bvh bvh = build_bvh(scene, width);
    Renderer in_bands = start_render(device(), scene, bvh, {.on_device = 1});
    EXPECT_GT(in_bands.plan.bands, 1u);
    for (const uint samples : {3u, 5u}) render_pass(in_bands, samples);
    EXPECT_EQ(different_pixels(once, read_film(in_bands)), 0u) << width;
  }
  record_law("X15");
}

TEST(metamorphic_image, depth_0_is_black_1_is_emission_2_adds_direct_light) {
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  add_quad(add_shape(world, diffuse(0.5), Sides::front, 1.0).mesh, {-1, 1, 0}, {2, 0, 0}, {0, 0, 2});  // faces -y
  look(world, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.25, 16, 16);  // sees the floor alone
  const auto mean = [&](uint depth) {
    world.integrator.max_depth = depth;
    return estimate(render_full(world, 64)).mean;
  };
  const Film none = [&] {
    world.integrator.max_depth = 0;
    return render_full(world, 4);
  }();
  for (std::size_t i = 0; i < none.pixels.size(); ++i) {
    EXPECT_EQ(pixel_mean(none, i)[0], 0.0);
    EXPECT_EQ(pixel_alpha(none, i), 0.0);
  }
  EXPECT_EQ(mean(1), 0.0);
  const double direct = mean(2), indirect = mean(4);  // floor, lamp, floor, lamp
  EXPECT_GT(direct, 0.0);
  EXPECT_EQ(mean(3), direct);
  EXPECT_GT(indirect, direct);
  look(world, {0, 0, 1}, {0, 1, 1}, {0, 0, 1}, 0.25, 16, 16);  // sees the lamp alone
  world.integrator.rr_depth = no_roulette;
  world.integrator.max_depth = 1;
  expect_every_sample(render_full(world, 4), 1.0, 0.0);
}

// Camera rays pass through shapes that emit, and see nothing in the constant light; its light on other shapes stays.
TEST(metamorphic_image, hidden_emitters_are_seen_in_mirrors) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_quad(add_shape(world, mirror(1.0), Sides::both).mesh, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
  look_closely(world, {0.2, 1, 0.3}, {0, 0, 0});
  world.integrator.hide_emitters = true;
  expect_every_sample(render_full(world, 4), 1.0, 8 * unit_roundoff);
}

TEST(metamorphic_image, hidden_emitters_are_not_seen_and_still_shine) {
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  add_sphere(world, diffuse(0.5), Sides::both, {0, 0, 1}, 0.25, 4.0);
  look(world, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.04, 16, 16);  // the lamp fills the view
  world.integrator.max_depth = 2;
  const double seen = estimate(render_full(world, 16)).mean;
  EXPECT_GE(seen, 4.0);
  world.integrator.hide_emitters = true;
  const Film hidden = render_full(world, 512);
  // The floor straight below: E = pi Le (r / d)^2 cos^4 and the view reaches .12 to the side.
  EXPECT_NEAR(estimate(hidden).mean, 0.5 * 4.0 / 16.0, 0.02 * 0.5 * 4.0 / 16.0);
  for (std::size_t i = 0; i < hidden.pixels.size(); ++i) EXPECT_EQ(pixel_alpha(hidden, i), 1.0);

  World sky;
  add_light(sky, LIGHT_CONSTANT, glm::dvec3(1.0));
  look(sky, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 1.0, 16, 16);
  const Film open = render_full(sky, 4);
  expect_every_sample(open, 1.0, 0.0);
  sky.integrator.hide_emitters = true;
  const Film closed = render_full(sky, 4);
  EXPECT_EQ(estimate(closed).mean, 0.0);
  for (std::size_t i = 0; i < closed.pixels.size(); ++i) {
    EXPECT_EQ(pixel_alpha(open, i), 1.0);
    EXPECT_EQ(pixel_alpha(closed, i), 0.0);
  }
}
