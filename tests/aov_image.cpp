// The layers of --aov on analytic scenes. The camera rays of the first samples are taken from the device (camera_test judges
// them); what they meet is worked out in double.
#include <bit>
#include <cstring>
#include <functional>
#include <map>
#include <optional>

#include "../host/aov.h"
#include "image.h"
#include "textured.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr Aovs all_aovs = {true, true, true, true, true};
constexpr double infinity = std::numeric_limits<double>::infinity();

using Layers = std::map<std::string, std::vector<float>>;

struct Seen {
  Layers layers;
  std::vector<std::vector<Ray>> rays;  // of each sample, of each pixel, canonical
  CanonicalFrame frame;

  static glm::dvec3 unpack(const packed_float3& v) { return {v.x, v.y, v.z}; }
  double at(const std::string& name, std::size_t pixel) const { return layers.at(name)[pixel]; }
  glm::dvec3 vector(const std::string& name, const char* axes, std::size_t pixel) const {
    const auto component = [&](int i) { return at(name + "." + axes[i], pixel); };
    return {component(0), component(1), component(2)};
  }
  std::uint32_t primitive(std::size_t pixel) const { return std::bit_cast<std::uint32_t>(layers.at("primitive.id")[pixel]); }

  glm::dvec3 origin(std::size_t sample, std::size_t pixel) const {
    return frame.center + std::ldexp(1.0, frame.exponent) * unpack(rays[sample][pixel].origin);
  }
  glm::dvec3 direction(std::size_t sample, std::size_t pixel) const { return unpack(rays[sample][pixel].direction); }
};

Layers by_name(const std::vector<Layer>& layers) {
  Layers result;
  for (const Layer& layer : layers) result[layer.name] = layer.values;
  return result;
}

// The camera rays of one sample, by the stage of cl/stages.cl, row by row.
std::vector<Ray> camera_rays(const Renderer& renderer, const KernelOptions& options, cl_ulong sample) {
  const std::size_t items = padded_pixels(renderer.settings);
  static auto& programs = *new std::map<Features, cl::Program>;
  if (!programs.count(options.features))
    programs[options.features] = build_program(device(), kernel_directory() / "stages.cl", options);
  cl::Kernel kernel(programs[options.features], "camera_rays");
  const cl::Buffer paths(device().context, CL_MEM_READ_WRITE, items * sizeof(PathState));
  const cl_uint next = bind_scene(kernel, renderer.scene);
  kernel.setArg(next, paths);
  kernel.setArg(next + 1, cl_uint{0});
  kernel.setArg(next + 2, sample);
  device().queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(WORK_GROUP_SIZE));
  std::vector<PathState> states(items);
  device().queue.enqueueReadBuffer(paths, CL_TRUE, 0, items * sizeof(PathState), states.data());
  const uint width = renderer.settings.crop_width, height = renderer.settings.crop_height;
  const uint across = (width + TILE_WIDTH - 1) / TILE_WIDTH;
  std::vector<Ray> rays;
  for (uint y = 0; y < height; ++y)
    for (uint x = 0; x < width; ++x)
      rays.push_back(
          states[(y / TILE_WIDTH * across + x / TILE_WIDTH) * WORK_GROUP_SIZE + y % TILE_WIDTH * TILE_WIDTH + x % TILE_WIDTH]
              .ray);
  return rays;
}

Seen see(World world, const Aovs& wanted = all_aovs, bool with_rays = true) {
  world.keep_uvs = wanted.uv;
  Scene scene = place_scene(world);
  scene.features = every_feature;
  scene.exact_kernel = true;
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const Renderer renderer = start_render(device(), scene, bvh);
  Seen seen{by_name(render_aovs(renderer, scene, bvh, wanted)), {}, scene.frame};
  for (cl_ulong sample = 0; with_rays && sample < AOV_SAMPLES; ++sample)
    seen.rays.push_back(camera_rays(renderer, kernel_options(scene, bvh), sample));
  return seen;
}

// What the oracle says of one ray, in world space.
struct Met {
  double depth;
  glm::dvec3 normal, albedo;
  glm::dvec2 uv;
  double slack = 1.0;  // what the tolerance of depth, normal and coordinates is multiplied with
};

using Oracle = std::function<std::optional<Met>(const glm::dvec3& origin, const glm::dvec3& direction)>;

// Every pixel against the means of the oracle over its rays: albedo and normal over all, depth and uv over those that met
// something. A mean of 16 terms of the same sign adds up to 16 roundings to those of its terms.
void expect_means(const Seen& seen, const Oracle& oracle, const Met& tolerance) {
  std::size_t hit = 0, missed = 0, partly = 0;
  for (std::size_t pixel = 0; pixel < seen.rays[0].size(); ++pixel) {
    Met mean{};
    double hits = 0, slack = 1;
    for (std::size_t sample = 0; sample < AOV_SAMPLES; ++sample) {
      const auto met = oracle(seen.origin(sample, pixel), seen.direction(sample, pixel));
      if (!met) continue;
      ++hits;
      slack = std::max(slack, met->slack);
      mean.depth += met->depth;
      mean.uv += met->uv;
      mean.normal += met->normal / double{AOV_SAMPLES};
      mean.albedo += met->albedo / double{AOV_SAMPLES};
    }
    ++(hits == 0 ? missed : hits == AOV_SAMPLES ? hit : partly);
    const glm::dvec3 normal = seen.vector("normal", "XYZ", pixel), albedo = seen.vector("albedo", "RGB", pixel);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(normal[c], mean.normal[c], slack * tolerance.normal[c]) << pixel;
      EXPECT_NEAR(albedo[c], mean.albedo[c], tolerance.albedo[c]) << pixel;
    }
    if (hits == 0) {
      EXPECT_EQ(seen.at("depth.Z", pixel), infinity);
      EXPECT_EQ(seen.at("uv.U", pixel), 0.0);
      EXPECT_EQ(seen.at("uv.V", pixel), 0.0);
    } else {
      EXPECT_NEAR(seen.at("depth.Z", pixel), mean.depth / hits, slack * tolerance.depth) << pixel;
      EXPECT_NEAR(seen.at("uv.U", pixel), mean.uv.x / hits, slack * tolerance.uv.x) << pixel;
      EXPECT_NEAR(seen.at("uv.V", pixel), mean.uv.y / hits, slack * tolerance.uv.y) << pixel;
    }
  }
  EXPECT_GT(hit, 0u);
  EXPECT_GT(missed, 0u);
  EXPECT_GT(partly, 0u);
}

glm::dvec3 axis_of(const World& world) { return glm::normalize(glm::dvec3(world.camera.to_world[2])); }
glm::dvec3 eye_of(const World& world) { return glm::dvec3(world.camera.to_world[3]); }

// Of depths of walls of half-extent 50, in a frame of 64: 8 u for the point, 3 for the difference, 16 for the sum.
constexpr double wall_slack = 64.0 * 32 * unit_roundoff;

// A wall across the view of a camera at the origin, at depth `depth`.
World wall(double depth, uint width, uint height) {
  World world;
  add_quad(add_shape(world, diffuse(0.25), Sides::both).mesh, {-50, -50, depth}, {100, 0, 0}, {0, 100, 0});
  look(world, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1.0, width, height);
  return world;
}

// Two triangles that share an edge, tilted, with texture coordinates.
Mesh tilted_quad() {
  Mesh mesh;
  add_quad(mesh, {-20, -15, 60}, {35, 2, 12}, {-3, 28, -9});
  mesh.uvs = {{0.0, 0.0}, {1.5, 0.25}, {1.0, 2.0}, {-0.5, 1.0}};
  return mesh;
}

std::optional<Met> meet_mesh(const Mesh& mesh, const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& eye,
                             const glm::dvec3& axis) {
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x], e1 = mesh.positions[t.y] - a, e2 = mesh.positions[t.z] - a;
    const glm::dvec3 x = glm::inverse(glm::dmat3(e1, e2, -d)) * (o - a);  // b1, b2, distance
    if (x.x < 0 || x.y < 0 || x.x + x.y > 1 || x.z <= 0) continue;
    const glm::dvec3 n = glm::normalize(glm::cross(e1, e2));
    const glm::dvec2 uv = (1 - x.x - x.y) * mesh.uvs[t.x] + x.x * mesh.uvs[t.y] + x.y * mesh.uvs[t.z];
    return Met{glm::dot(o + x.z * d - eye, axis), glm::dot(n, d) < 0 ? n : -n, glm::dvec3(0.25), uv};
  }
  return std::nullopt;
}

}  // namespace

// Every hit point has the same depth, however far from the axis.
TEST(aov_image, depth_is_along_the_axis_and_the_normal_on_the_side_of_the_camera) {
  for (const bool back : {false, true}) {
    World world = wall(7.0, 12, 9);
    if (back) std::swap(world.shapes[0].mesh.triangles[0].x, world.shapes[0].mesh.triangles[0].y);
    if (back) std::swap(world.shapes[0].mesh.triangles[1].x, world.shapes[0].mesh.triangles[1].y);
    const Seen seen = see(world, all_aovs, false);
    for (std::size_t pixel = 0; pixel < 12 * 9; ++pixel) {
      EXPECT_NEAR(seen.at("depth.Z", pixel), 7.0, wall_slack);
      EXPECT_EQ(seen.vector("normal", "XYZ", pixel), glm::dvec3(0, 0, -1));
      EXPECT_EQ(seen.vector("albedo", "RGB", pixel), glm::dvec3(0.25));
      EXPECT_TRUE(seen.primitive(pixel) == 1u || seen.primitive(pixel) == 2u);
    }
  }
}

// Far from the world's origin, and not of size 1. Where the ray meets the sphere at an angle of cosine c, the point errs by
// some 64 u of the frame over c; the visible normals stay 0.2 away from the poles, where coordinates have no meaning.
TEST(aov_image, a_sphere_has_its_own_depth_normal_and_coordinates_and_nothing_is_around_it) {
  const glm::dvec3 center(100, -30, 7);
  const double radius = 40.0;
  World world;
  add_sphere(world, diffuse(0.25), Sides::both, center, radius);
  look(world, {-80, 20, 10}, {110, -20, 0}, {0, 0, 1}, 0.35, 24, 18);
  const Seen seen = see(world);
  const glm::dvec3 eye = eye_of(world), axis = axis_of(world);
  bool grazes = false;  // any ray of the test so near to the silhouette that rounding decides
  const Oracle oracle = [&](const glm::dvec3& o, const glm::dvec3& d) -> std::optional<Met> {
    const glm::dvec3 to = center - o;
    const double along = glm::dot(to, d) / glm::dot(d, d), square = glm::dot(d, d);
    const double distance2 = glm::dot(to - along * d, to - along * d);
    grazes = grazes || std::abs(distance2 - radius * radius) < 64 * unit_roundoff * radius * radius;
    if (distance2 > radius * radius) return std::nullopt;
    const glm::dvec3 p = o + (along - std::sqrt((radius * radius - distance2) / square)) * d;
    const glm::dvec3 n = (p - center) / radius;
    const double turns = std::atan2(n.y, n.x) / (2 * glm::pi<double>());
    return Met{glm::dot(p - eye, axis),
               n,
               glm::dvec3(0.25),
               {turns < 0 ? turns + 1 : turns, std::acos(n.z) / glm::pi<double>()},
               radius / std::sqrt(radius * radius - distance2)};
  };
  const double point = 64 * unit_roundoff * 64.0;  // in a frame of half-extent 64
  expect_means(seen, oracle,
               {point, glm::dvec3(point / radius), glm::dvec3(unit_roundoff), glm::dvec2(point / radius / 0.2)});
  EXPECT_FALSE(grazes);
  for (std::size_t pixel = 0; pixel < seen.rays[0].size(); ++pixel) EXPECT_LE(seen.primitive(pixel), 1u);
}

// Points err by 8 u of the frame, and where the plane is met at an angle by that over its cosine, here above 1/2.
// Coordinates: over the shorter edge as well, 28 of the frame's half-extent of 64 at most, and times the largest change
// of 2.
TEST(aov_image, a_tilted_quad_has_its_planes_depth_and_its_own_coordinates) {
  World world;
  WorldShape& shape = add_shape(world, diffuse(0.25), Sides::both);
  shape.mesh = tilted_quad();
  look(world, {0, 0, 0}, {-2, 0, 60}, {0, 1, 0}, 0.6, 24, 18);
  const Seen seen = see(world);
  const double point = 64.0 * 32 * unit_roundoff;
  expect_means(seen,
               [&](const glm::dvec3& o, const glm::dvec3& d) {
                 return meet_mesh(tilted_quad(), o, d, eye_of(world), axis_of(world));
               },
               {4 * point, glm::dvec3(32 * unit_roundoff), glm::dvec3(unit_roundoff), glm::dvec2(4 * point * 2 / 28)});
  bool first = false, second = false;
  for (std::size_t pixel = 0; pixel < seen.rays[0].size(); ++pixel) {
    first = first || seen.primitive(pixel) == 1;
    second = second || seen.primitive(pixel) == 2;
    EXPECT_LE(seen.primitive(pixel), 2u);
  }
  EXPECT_TRUE(first && second);
}

// The camera stands 1000 away, and its rays begin where the scene does.
TEST(aov_image, orthographic_depth_counts_from_the_camera) {
  World world;
  add_shape(world, diffuse(0.25), Sides::both).mesh = tilted_quad();
  look(world, {-2, 0, -940}, {-2, 0, 60}, {0, 1, 0}, 1.0, 24, 18);
  world.camera.orthographic = true;
  world.camera.tan_half_fov_x = 30.0;
  const Seen seen = see(world);
  const double point = 64.0 * 32 * unit_roundoff;
  expect_means(seen,
               [&](const glm::dvec3& o, const glm::dvec3& d) {
                 return meet_mesh(tilted_quad(), o, d, eye_of(world), axis_of(world));
               },
               {4 * point + 1000 * unit_roundoff, glm::dvec3(32 * unit_roundoff), glm::dvec3(unit_roundoff),
                glm::dvec2(4 * point * 2 / 28)});
}

// Four texels without interpolation. A sample within 1e-4 of an edge between two could be either: none is.
TEST(aov_image, albedo_is_what_the_texture_says) {
  const std::vector<float> texels = {0.1f, 0.2f, 0.3f, 0.9f, 0.8f, 0.7f, 0.4f, 0.5f, 0.6f, 0.0f, 1.0f, 0.5f};
  World world;
  Material material = diffuse(0.0);
  material.reflectance_texture = add_bitmap(world, 2, 2, 3, texels);
  world.textures.back().nearest = true;
  add_shape(world, material, Sides::both).mesh = tilted_quad();
  look(world, {0, 0, 0}, {-2, 0, 60}, {0, 1, 0}, 0.6, 24, 18);
  const Seen seen = see(world);
  bool near_edge = false;
  const auto oracle = [&](const glm::dvec3& o, const glm::dvec3& d) {
    auto met = meet_mesh(tilted_quad(), o, d, eye_of(world), axis_of(world));
    if (!met) return met;
    const glm::dvec2 place = 2.0 * (met->uv - glm::floor(met->uv)), from_edge = glm::abs(place - glm::round(place));
    near_edge = near_edge || std::min(from_edge.x, from_edge.y) < 1e-4;
    const std::size_t texel = 2 * static_cast<std::size_t>(place.y) + static_cast<std::size_t>(place.x);
    met->albedo = {texels[3 * texel], texels[3 * texel + 1], texels[3 * texel + 2]};
    return met;
  };
  const double point = 64.0 * 32 * unit_roundoff;
  expect_means(seen, oracle,
               {4 * point, glm::dvec3(32 * unit_roundoff), glm::dvec3(16 * unit_roundoff), glm::dvec2(4 * point * 2 / 28)});
  EXPECT_FALSE(near_edge) << "another seed is needed";
}

TEST(aov_image, a_normal_map_tilts_the_normal) {
  World world = wall(7.0, 8, 8);
  world.shapes[0].mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const glm::dvec3 tilted = glm::normalize(glm::dvec3(0.3, -0.2, 0.9));
  world.materials[0].normal_texture = add_constant(world, normal_color(tilted));
  const Seen seen = see(world);
  // u runs along +x and v along +y; the front of the quad faces +z and the camera sees its back: what the front has is
  // mirrored in it.
  const glm::dvec3 expected(tilted.x, tilted.y, -tilted.z);
  for (std::size_t pixel = 0; pixel < 64; ++pixel)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.vector("normal", "XYZ", pixel)[c], expected[c], 64 * unit_roundoff);
}

TEST(aov_image, triangles_and_quadrics_have_numbers_of_their_own) {
  World world;
  Mesh& mesh = add_shape(world, diffuse(0.5), Sides::both).mesh;
  for (int i = 0; i < 3; ++i) add_quad(mesh, {4.0 * i, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (int i = 0; i < 2; ++i) add_sphere(world, diffuse(0.5), Sides::both, {4.0 * i, 6, 0}, 1.0);
  std::vector<std::uint32_t> found;
  const auto look_at = [&](const glm::dvec3& target) {
    look(world, target - glm::dvec3(0, 0, 3), target, {0, 1, 0}, 1e-3, 1, 1);
    found.push_back(see(world, all_aovs, false).primitive(0));
  };
  for (int i = 0; i < 3; ++i) look_at({4.0 * i + 0.75, 0.25, 0}), look_at({4.0 * i + 0.25, 0.75, 0});
  for (int i = 0; i < 2; ++i) look_at({4.0 * i, 6, 0});
  look_at({0, 20, 0});
  EXPECT_EQ(found, (std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 7, 8, 0}));
}

// Of each sample the mask decides anew; of the primitive the larger share does. Depths tell how many samples went through;
// the sums of 1/4 and 1 are exact in float.
TEST(aov_image, a_mask_is_there_as_often_as_it_is_opaque) {
  for (const double transparency : {0.25, 0.75}) {
    World world = wall(8.0, 32, 32);
    Material mask = diffuse(1.0);
    mask.transparency = static_cast<float>(transparency);
    add_quad(add_shape(world, mask, Sides::both).mesh, {-50, -50, 4}, {100, 0, 0}, {0, 100, 0});
    const Seen seen = see(world, all_aovs, false);
    double through = 0;
    constexpr double samples = 32 * 32 * AOV_SAMPLES;
    for (std::size_t pixel = 0; pixel < 32 * 32; ++pixel) {
      const double behind = (seen.at("depth.Z", pixel) - 4.0) / 4.0 * AOV_SAMPLES;
      ASSERT_NEAR(behind, std::round(behind), AOV_SAMPLES / 4.0 * wall_slack);
      EXPECT_EQ(seen.at("albedo.R", pixel), (AOV_SAMPLES - 0.75 * std::round(behind)) / AOV_SAMPLES);
      EXPECT_EQ(seen.primitive(pixel) <= 2, transparency > 0.5);
      through += std::round(behind);
    }
    EXPECT_NEAR(through / samples, transparency, z_bound(2) * std::sqrt(transparency * (1 - transparency) / samples));
  }
}

TEST(aov_image, lights_that_are_hidden_from_the_camera_are_not_in_its_way) {
  for (const bool hidden : {false, true}) {
    World world = wall(8.0, 8, 8);
    add_quad(add_shape(world, diffuse(0.0), Sides::both, 3.0).mesh, {-50, 50, 4}, {100, 0, 0}, {0, -100, 0});
    world.integrator.hide_emitters = hidden;
    const Seen seen = see(world, all_aovs, false);
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
      EXPECT_NEAR(seen.at("depth.Z", pixel), hidden ? 8.0 : 4.0, wall_slack);
      EXPECT_EQ(seen.primitive(pixel) <= 2, hidden);
    }
  }
}

TEST(aov_image, a_surface_that_absorbs_everything_has_no_albedo_but_a_depth) {
  World world = wall(8.0, 8, 8);
  world.shapes[0].material_back = NONE;  // the side that is seen
  const Seen seen = see(world, all_aovs, false);
  for (std::size_t pixel = 0; pixel < 64; ++pixel) {
    EXPECT_EQ(seen.vector("albedo", "RGB", pixel), glm::dvec3(0.0));
    EXPECT_EQ(seen.vector("normal", "XYZ", pixel), glm::dvec3(0, 0, -1));
    EXPECT_NEAR(seen.at("depth.Z", pixel), 8.0, wall_slack);
  }
}

// More pixels than a launch has work items; the crop begins within a tile.
TEST(aov_image, a_crop_has_the_very_values_of_the_whole) {
  World world;
  add_sphere(world, diffuse(0.5), Sides::both, {0, 0, 5}, 2.0);
  look(world, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.5, 272, 256);
  ASSERT_GT(272u * 256u, max_launch);
  const Seen whole = see(world, all_aovs, false);
  world.film.crop_x = 101;
  world.film.crop_y = 203;
  world.film.crop_width = 37;
  world.film.crop_height = 53;
  const Seen crop = see(world, all_aovs, false);
  for (const auto& [name, values] : crop.layers) {
    ASSERT_EQ(values.size(), 37u * 53u) << name;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float expected = whole.layers.at(name)[(203 + i / 37) * 272 + 101 + i % 37];
      ASSERT_EQ(std::bit_cast<std::uint32_t>(values[i]), std::bit_cast<std::uint32_t>(expected)) << name << " " << i;
    }
  }
}

TEST(aov_image, layers_depend_on_no_sample_that_was_rendered_and_on_no_feature_that_was_compiled) {
  World world = wall(8.0, 16, 16);
  Material mask = diffuse(1.0);
  mask.transparency = 0.5f;
  add_quad(add_shape(world, mask, Sides::both).mesh, {-50, -50, 4}, {100, 0, 0}, {0, 100, 0});
  const Layers expected = see(world, all_aovs, false).layers;
  EXPECT_EQ(expected.size(), 3u + 3u + 1u + 2u + 1u);
  world.keep_uvs = true;
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  renderer.first_sample = 7 * REPLICA_SAMPLES;
  render_pass(renderer, 3);
  const Layers found = by_name(render_aovs(renderer, scene, bvh, all_aovs));
  for (const auto& [name, values] : expected)
    EXPECT_EQ(std::memcmp(values.data(), found.at(name).data(), values.size() * sizeof(float)), 0) << name;
}

TEST(aov_image, only_the_wanted_layers_are_made) {
  const World world = wall(8.0, 8, 8);
  const auto names = [&](const Aovs& wanted) {
    std::vector<std::string> list;
    for (const auto& entry : see(world, wanted, false).layers) list.push_back(entry.first);
    return list;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({}), Names{});
  EXPECT_EQ(names({.depth = true}), Names{"depth.Z"});
  EXPECT_EQ(names({.albedo = true, .primitive = true}), (Names{"albedo.B", "albedo.G", "albedo.R", "primitive.id"}));
}

TEST(aov_image, texture_coordinates_that_nothing_but_a_layer_reads_change_no_bit_of_the_film) {
  World world = wall(8.0, 16, 16);
  world.shapes[0].mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  add_light(world, LIGHT_POINT, glm::dvec3(1.0), {0, 0, 1});
  const Film without = render_full(world, 3);
  world.keep_uvs = true;
  const Film with = render_full(world, 3);
  EXPECT_EQ(std::memcmp(without.pixels.data(), with.pixels.data(), with.pixels.size() * sizeof(FilmPixel)), 0);
  EXPECT_GT(pixel_mean(with, 0)[0], 0.0);
}
