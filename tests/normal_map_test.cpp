// Tilted shading frames (extreme X41): decoding of normal maps, tangent frames, normals of displaced surfaces.
#include "extremes.h"
#include "textured.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

using Slope = std::array<float, 2>;
using Precise = glm::vec<3, long double>;

Precise precise(const packed_float3& v) { return {v.x, v.y, v.z}; }

std::vector<packed_float3> decode(const std::vector<packed_float3>& colors) {
  std::vector<packed_float3> normals(colors.size());
  run("normal_map_test.cl", "decode", colors.size(), colors, out(normals));
  return normals;
}

struct Columns {
  packed_float3 x, y, z;
};

std::vector<Columns> tangent_frames(const std::vector<packed_float3>& z, const std::vector<packed_float3>& dp_du) {
  std::vector<Columns> frames(z.size());
  run("normal_map_test.cl", "tangent_frames", z.size(), z, dp_du, out(frames));
  return frames;
}

struct Bump {
  packed_float3 n, du, dv;
  Slope slope;
};

std::vector<packed_float3> bump_normals(const std::vector<Bump>& bumps) {
  std::vector<packed_float3> n, du, dv, normals(bumps.size());
  std::vector<Slope> slopes;
  for (const Bump& b : bumps) n.push_back(b.n), du.push_back(b.du), dv.push_back(b.dv), slopes.push_back(b.slope);
  run("normal_map_test.cl", "bumps", bumps.size(), n, du, dv, slopes, out(normals));
  return normals;
}

// What rays meet of a world: where, and the normals with and without its maps.
struct Shading {
  std::vector<Hit> hits;
  std::vector<packed_float3> normals, untilted;
};

Shading shade(const Scene& scene, const std::vector<Ray>& rays) {
  const Bvh bvh = build_bvh(scene, 8);
  Shading s{trace_closest(scene, bvh, rays), std::vector<packed_float3>(rays.size()), std::vector<packed_float3>(rays.size())};
  EXPECT_EQ(missed(s.hits), 0u);
  run_with({every_feature, 8}, "normal_map_test.cl", "shading_normals", rays.size(), bvh.blocks, scene.quadrics, scene.shapes,
           scene.triangle_shape, scene.triangle_vertices, scene.normals, scene.uvs, scene.materials, scene.textures, scene.texels, rays,
           s.hits, out(s.normals), out(s.untilted));
  return s;
}

// A parallelogram p = origin + s x + t y with texture coordinates that are an affine map of (s, t).
struct Plane {
  glm::dvec3 origin{0.2, -0.3, 0.1}, x{0.9, 0.3, 0.2}, y{-0.1, 0.8, 0.4};
  glm::dmat2 uv_of{1.1, 0.3, -0.4, 0.8};  // columns: of s, of t
  glm::dvec2 uv_origin{0.15, 0.35};
};

WorldShape& add_plane(World& world, const Plane& p, const Material& material) {
  WorldShape& shape = add_shape(world, material, Sides::both);
  add_quad(shape.mesh, p.origin, p.x, p.y);
  for (const glm::dvec2& st : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) shape.mesh.uvs.push_back(p.uv_origin + p.uv_of * st);
  return shape;
}

// Rays at points (s, t) of the plane, from its front and from its back by turns, within 60 degrees of the normal.
struct PlaneRays {
  std::vector<glm::dvec2> st;
  std::vector<Ray> rays;
  std::vector<bool> front;
};

PlaneRays rays_at(const Plane& p, const Scene& scene, std::size_t count, Random& random) {
  PlaneRays result;
  const glm::dvec3 n = glm::normalize(glm::cross(p.x, p.y));
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec2 st(random.between(0.02, 0.98), random.between(0.02, 0.98));
    const bool front = i % 2 == 0;
    const glm::dvec3 at = scene.frame.place(p.origin + st.x * p.x + st.y * p.y);
    glm::dvec3 side = random.direction();
    side -= n * glm::dot(side, n);
    const glm::dvec3 from = at + 0.1 * ((front ? n : -n) + random.between(0.0, 1.7) * glm::normalize(side));
    result.st.push_back(st);
    result.rays.push_back(ray_towards(from, at));
    result.front.push_back(front);
  }
  return result;
}

Precise normalized(const Precise& v) { return v / std::sqrt(glm::dot(v, v)); }
double distance(const Precise& a, const packed_float3& b) { const Precise d = a - precise(b); return static_cast<double>(std::sqrt(glm::dot(d, d))); }

// Of a vector mirrored in the plane with the unit normal n.
Precise mirrored(const Precise& v, const Precise& n) { return v - 2.0L * glm::dot(v, n) * n; }

bool is(const packed_float3& v, float x, float y, float z) { return v.x == x && v.y == y && v.z == z; }

}  // namespace

TEST(normal_map_test, what_says_nothing_about_the_normal_leaves_it_alone) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity(), middle = 128.0f / 255.0f;
  const std::vector<packed_float3> colors = {{0, 0, 0},      {middle, middle, middle}, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 1.0f}, {1, 0.5f, 0.5f},
                                             {1, 0, 0.25f},  {0.5f, 0.5f, 0},          {nan, 0.5f, 1},     {0.5f, nan, 1},     {0.5f, 0.5f, nan},
                                             {inf, 0.5f, 1}, {0.5f, -inf, 1},          {0.5f, 0.5f, inf},  {0.5f, 0.5f, 0.5049f}, {1e30f, 0.5f, 1}};
  const std::vector<packed_float3> normals = decode(colors);
  for (std::size_t i = 0; i < colors.size(); ++i) EXPECT_TRUE(is(normals[i], 0, 0, 1)) << i << ": " << normals[i].x << " " << normals[i].y << " " << normals[i].z;
  record_law("X41");
}

// 2 c - 1 errs by u at most (exactly for c >= 1/4), the normalisation by 6 u.
TEST(normal_map_test, a_colour_is_the_normal_2c_minus_1_brought_to_length_1) {
  Random random(1);
  std::vector<packed_float3> colors = {{0.505f, 0.5f, 0.505f}, {1, 1, 1}, {0, 0, 1}, {128 / 255.0f, 128 / 255.0f, 1}, {0.5f, 1, 0.5000001f}};
  while (colors.size() < count_or_small(100000, 50)) colors.push_back({random.unit24(), random.unit24(), 0.51f + 0.49f * random.unit24()});
  const std::vector<packed_float3> normals = decode(colors);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Precise n = 2.0L * precise(colors[i]) - 1.0L;
    EXPECT_LE(distance(normalized(n), normals[i]), (2.0 / static_cast<double>(std::sqrt(glm::dot(n, n))) + 6) * unit_roundoff) << i;
  }
}

// x: error of the subtraction, 4 u, over what is left of dp_du across z, taken out along z; so the frame is orthonormal to some u.
TEST(normal_map_test, the_tangent_frame_is_orthonormal_and_its_x_lies_along_dp_du) {
  Random random(2);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<packed_float3> odd = {{0, 0, 0}, {nan, 1, 0}, {1, nan, nan}, {inf, 0, 0}, {1e-38f, 0, 1e-38f}, {1e-45f, 0, 0}, {3e38f, 3e38f, 0}, {0, -1e33f, 0}};
  std::vector<packed_float3> z, dp_du;
  const std::size_t count = count_or_small(60000, 60);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 n = i % 7 ? random.direction() : glm::dvec3(0, 0, random.sign());
    z.push_back(packed(n));
    if (i % 4 == 0) dp_du.push_back(odd[i / 4 % odd.size()]);
    else if (i % 4 == 1) dp_du.push_back(packed(random.log_between(1e-9, 1e9) * n));  // along z but for rounding
    else if (i % 4 == 2) dp_du.push_back(packed(n + random.log_between(1e-8, 1) * random.direction()));
    else dp_du.push_back(packed(random.log_between(1e-35, 1e29) * random.direction()));
  }
  const std::vector<Columns> frames = tangent_frames(z, dp_du);
  std::size_t along = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Precise x = precise(frames[i].x), y = precise(frames[i].y), n = precise(z[i]);
    EXPECT_EQ(distance(n, frames[i].z), 0.0);
    for (const long double error : {glm::dot(x, x) - 1, glm::dot(y, y) - 1, glm::dot(x, y), glm::dot(x, n), glm::dot(y, n), glm::dot(glm::cross(n, x), y) - 1})
      EXPECT_LE(std::abs(error), 12 * unit_roundoff) << i << ": " << dp_du[i].x << " " << dp_du[i].y << " " << dp_du[i].z;
    const Precise u = precise(dp_du[i]);
    const long double largest = std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)});
    if (!(largest >= 1e-36L && largest <= 9.9e29L) || std::isnan(u.x + u.y + u.z)) continue;
    const Precise across = (u - n * (glm::dot(n, u) / glm::dot(n, n))) / largest;
    const double length = static_cast<double>(std::sqrt(glm::dot(across, across)));
    if (length < 1.1e-3) continue;
    EXPECT_LE(distance(normalized(across), frames[i].x), (8 / length + 6) * unit_roundoff) << i;
    ++along;
  }
  EXPECT_GT(along, count / 4);
}

// Each derivative, scaled to 1, errs by 6 u and by what its part along n leaves, 4 u |derivative|; the cross product turns that
// into an angle by its length.
TEST(normal_map_test, the_bump_normal_is_that_of_the_displaced_tangent_plane) {
  Random random(3);
  std::vector<Bump> bumps;
  for (std::size_t i = 0; i < count_or_small(100000, 100); ++i) {
    const glm::dvec3 n = random.direction();
    const double size = random.log_between(1e-12, 1e12);
    const auto derivative = [&] { return size * random.log_between(0.1, 10) * (i % 3 ? random.direction() : glm::normalize(glm::cross(n, random.direction()))); };
    const auto slope = [&] { return static_cast<float>(size * random.signed_log_between(1e-6, 1e3)); };
    bumps.push_back({packed(n), packed(derivative()), packed(derivative()), {slope(), i % 5 ? slope() : 0.0f}});
  }
  const std::vector<packed_float3> normals = bump_normals(bumps);
  std::size_t judged = 0;
  for (std::size_t i = 0; i < bumps.size(); ++i) {
    const Precise n = normalized(precise(bumps[i].n));
    long double magnitude = 1;
    const auto displaced = [&](const packed_float3& p, float slope) {
      const Precise d = precise(p), along = d - n * glm::dot(n, d);
      const long double largest = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z), static_cast<long double>(std::abs(slope))});
      magnitude += std::sqrt(glm::dot(d, d)) / largest;
      return (along + n * static_cast<long double>(slope)) / largest;
    };
    const Precise du = displaced(bumps[i].du, bumps[i].slope[0]), dv = displaced(bumps[i].dv, bumps[i].slope[1]);
    Precise m = glm::cross(du, dv);
    const long double length = std::sqrt(glm::dot(m, m));
    if (length < 1e-3L || std::abs(glm::dot(normalized(m), n)) < 1e-3L) continue;  // parallel, or edge-on: the side is rounding
    if (glm::dot(m, n) < 0) m = -m;
    EXPECT_LE(distance(normalized(m), normals[i]), static_cast<double>(12 * magnitude / length) * unit_roundoff) << i;
    ++judged;
  }
  EXPECT_GT(judged, bumps.size() / 2);
}

TEST(normal_map_test, a_bump_without_direction_or_number_leaves_the_normal_alone) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const packed_float3 n{0, 0, 1}, x{1, 0, 0}, y{0, 1, 0}, zero{0, 0, 0};
  const std::vector<Bump> bumps = {{n, zero, y, {0, 0.5f}}, {n, x, zero, {1, 0}},  {n, zero, zero, {1, 1}}, {n, x, x, {0, 0}},       {n, x, y, {nan, 0}},
                                   {n, x, y, {0, nan}},     {n, x, y, {inf, 0}},   {n, x, y, {0, 0}},       {n, {nan, 0, 0}, y, {1, 0}}, {n, x, {0, inf, 0}, {1, 0}},
                                   {n, n, y, {0, 1}}};
  for (const packed_float3& m : bump_normals(bumps)) EXPECT_TRUE(is(m, 0, 0, 1)) << m.x << " " << m.y << " " << m.z;
}

// Only ratios count: a surface and its heights in another unit.
TEST(normal_map_test, lengths_times_a_power_of_two_give_the_same_bump_bit_for_bit) {
  Random random(4);
  std::vector<Bump> bumps, scaled;
  const auto times = [](float k, packed_float3 v) { return packed_float3{k * v.x, k * v.y, k * v.z}; };
  for (std::size_t i = 0; i < count_or_small(10000, 40); ++i) {
    const Bump b{packed(random.direction()), packed(random.direction()), packed(random.direction()), {random.unit24(), random.unit24()}};
    const float k = std::ldexp(1.0f, static_cast<int>(random.below(121)) - 60);
    bumps.push_back(b);
    scaled.push_back({b.n, times(k, b.du), times(k, b.dv), {k * b.slope[0], k * b.slope[1]}});
  }
  const std::vector<packed_float3> a = bump_normals(bumps), b = bump_normals(scaled);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

// Texture coordinates err by 8 u of 2, so the weight of a texel by 16 u W; heights are below 1, W of them to a unit of u.
TEST(normal_map_test, a_bumpy_plane_has_the_normal_of_the_displaced_plane) {
  Random random(5);
  const Plane plane;
  const HeightField field{8, 5, random_numbers(40, 6)};
  const double scale = 0.07;
  World world;
  Material m = diffuse(0.5);
  m.bump_texture = add_bitmap(world, field.width, field.height, 1, field.values);
  m.bump_scale = static_cast<float>(scale);
  add_plane(world, plane, m);
  const Scene scene = place_scene(world);
  const PlaneRays at = rays_at(plane, scene, count_or_small(20000, 30), random);
  const Shading shading = shade(scene, at.rays);
  const Precise x = plane.x, y = plane.y, n = normalized(glm::cross(x, y));
  const glm::dmat2 st_of = glm::inverse(plane.uv_of);
  std::size_t judged = 0;
  for (std::size_t i = 0; i < at.rays.size(); ++i) {
    const glm::dvec2 uv = plane.uv_origin + plane.uv_of * at.st[i];
    if (!field.smooth_at(uv.x, uv.y, 1e-3L)) continue;
    // The displaced plane at three points of its one bilinear patch: differences along u and v are exact there.
    const long double h = 1e-4L;
    const auto displaced = [&](long double du, long double dv) {
      const glm::dvec2 st = at.st[i] + st_of * glm::dvec2(du, dv);
      return x * static_cast<long double>(st.x) + y * static_cast<long double>(st.y) + n * (static_cast<long double>(m.bump_scale) * field.at(uv.x + du, uv.y + dv));
    };
    const Precise center = displaced(0, 0);
    Precise expected = normalized(glm::cross(displaced(h, 0) - center, displaced(0, h) - center));
    if (glm::dot(expected, n) < 0) expected = -expected;
    if (!at.front[i]) expected = mirrored(expected, n);  // a bump is a bump from both sides
    if (glm::dot(expected, -precise(at.rays[i].direction)) < 1e-3L) expected = at.front[i] ? n : -n;
    // the ray's rounding moves the point by some u of the scene, and with it u and v by at most 16 u
    const double slope_error = scale * 8 * (8 + 32 * 8) * unit_roundoff;
    EXPECT_LE(distance(expected, shading.normals[i]), 40 * unit_roundoff + 4 * slope_error) << i;
    judged += glm::dot(expected, n) * glm::dot(expected, n) < 0.999L;
  }
  EXPECT_GT(judged, at.rays.size() / 3);
}

// The curvature of the sphere itself is left out (Blinn 1978): its normal counts as constant around the point.
TEST(normal_map_test, a_bumpy_sphere_has_the_normal_of_the_sphere_displaced_along_one_normal) {
  Random random(7);
  const HeightField field{16, 9, random_numbers(144, 8)};
  const glm::dvec3 center(0.3, -0.2, 0.1), turn_x = glm::normalize(glm::dvec3(1, 2, 2)), turn_y = glm::normalize(glm::dvec3(2, 1, -2)), turn_z = glm::cross(turn_x, turn_y);
  const double r = 0.7, scale = 0.05;
  World world;
  Material m = diffuse(0.5);
  m.bump_texture = add_bitmap(world, field.width, field.height, 1, field.values);
  m.bump_scale = static_cast<float>(scale);
  WorldShape& shape = add_shape(world, m, Sides::both);
  shape.geometry = Geometry::sphere;
  shape.to_world = glm::dmat4(glm::dvec4(r * turn_x, 0), glm::dvec4(r * turn_y, 0), glm::dvec4(r * turn_z, 0), glm::dvec4(center, 1));
  const Scene scene = place_scene(world);
  std::vector<Ray> rays;
  std::vector<glm::dvec2> uvs;
  const auto sphere = [&](long double u, long double v) {
    const long double phi = 2 * glm::pi<long double>() * u, theta = glm::pi<long double>() * v;
    return Precise(turn_x) * (std::sin(theta) * std::cos(phi)) + Precise(turn_y) * (std::sin(theta) * std::sin(phi)) + Precise(turn_z) * std::cos(theta);
  };
  for (std::size_t i = 0; i < count_or_small(20000, 30); ++i) {
    uvs.push_back({random.unit(), random.between(0.05, 0.95)});
    const glm::dvec3 n = sphere(uvs[i].x, uvs[i].y), at = center + r * n;
    const glm::dvec3 aside = 0.3 * glm::normalize(glm::cross(n, random.direction()));
    rays.push_back(ray_towards(scene.frame.place(at + 0.2 * ((i % 2 ? -n : n) + aside)), scene.frame.place(at)));
  }
  const Shading shading = shade(scene, rays);
  std::size_t judged = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const long double u = uvs[i].x, v = uvs[i].y, h = 1e-6L;
    if (!field.smooth_at(u, v, 1e-2L)) continue;
    const Precise n = sphere(u, v);
    const auto displaced = [&](long double a, long double b) { return static_cast<long double>(r) * sphere(a, b) + n * (static_cast<long double>(m.bump_scale) * field.at(a, b)); };
    Precise expected = normalized(glm::cross(displaced(u + h, v) - displaced(u - h, v), displaced(u, v + h) - displaced(u, v - h)));
    if (glm::dot(expected, n) < 0) expected = -expected;
    if (i % 2) expected = mirrored(expected, n);
    if (glm::dot(expected, -precise(rays[i].direction)) < 1e-3L) expected = i % 2 ? -n : n;
    // The hit lies within 64 u of the point aimed at: that turns the normal by 64 u / r, and moves u and v by 64 u / (2 pi r sin)
    // and so the slope by W times the height's 16 or 9 steps. Near the poles |dp_du| shrinks with the sine.
    const double sine = std::sin(glm::pi<double>() * uvs[i].y);
    const double tolerance = 128 / r * unit_roundoff * (1 + scale * 16 * 16 / (r * sine * sine));
    EXPECT_LE(distance(expected, shading.normals[i]), tolerance) << i << " " << uvs[i].x << " " << uvs[i].y;
    ++judged;
  }
  EXPECT_GT(judged, rays.size() / 2);
}

// x along dp_du, y across it as seen from the front, z the normal. On the back: mirrored, or where the map is turned, the contrary
// of the front's.
TEST(normal_map_test, a_normal_map_tilts_the_normal_in_the_frame_of_u) {
  Random random(9);
  const Plane plane;
  for (const bool turned : {false, true}) {
    const glm::dvec3 said = glm::normalize(turned ? glm::dvec3(0.3, -0.2, 0.9) : glm::dvec3(0, -0.2, 0.9));
    World world;
    Material m = diffuse(0.5);
    m.normal_texture = add_constant(world, normal_color(said));
    WorldShape& shape = add_plane(world, plane, m);
    if (turned) {
      m.normal_turned = 1;
      shape.material_back = static_cast<uint>(world.materials.size());
      world.materials.push_back(m);
    }
    const Scene scene = place_scene(world);
    const PlaneRays at = rays_at(plane, scene, count_or_small(2000, 20), random);
    const Shading shading = shade(scene, at.rays);
    const glm::dmat2 st_of = glm::inverse(plane.uv_of);
    const Precise dp_du = Precise(plane.x) * static_cast<long double>(st_of[0].x) + Precise(plane.y) * static_cast<long double>(st_of[0].y);
    const Precise z = normalized(glm::cross(Precise(plane.x), Precise(plane.y))), x = normalized(dp_du - z * glm::dot(z, dp_du)), y = glm::cross(z, x);
    const Precise tilted = x * static_cast<long double>(said.x) + y * static_cast<long double>(said.y) + z * static_cast<long double>(said.z);
    for (std::size_t i = 0; i < at.rays.size(); ++i) {
      Precise expected = at.front[i] ? tilted : turned ? -tilted : mirrored(tilted, z);
      const long double seen = glm::dot(expected, -precise(at.rays[i].direction));
      if (std::abs(seen) < 1e-4L) continue;
      if (seen < 0) expected = at.front[i] ? z : -z;  // the viewer cannot see it
      EXPECT_LE(distance(expected, shading.normals[i]), 40 * unit_roundoff) << i;
    }
  }
}

TEST(normal_map_test, a_turned_bump_is_the_contrary_of_the_bump_in_front) {
  Random random(10);
  const Plane plane;
  World world;
  Material m = diffuse(0.5);
  m.normal_texture = add_constant(world, normal_color(glm::normalize(glm::dvec3(-0.1, 0.2, 0.9))));
  m.bump_texture = add_bitmap(world, 4, 4, 1, random_numbers(16, 11));
  m.bump_scale = 0.03f;
  WorldShape& shape = add_plane(world, plane, m);
  m.normal_turned = 1;
  m.bump_scale = -m.bump_scale;
  shape.material_back = static_cast<uint>(world.materials.size());
  world.materials.push_back(m);
  const Scene scene = place_scene(world);
  const glm::dvec3 n = glm::normalize(glm::cross(plane.x, plane.y));
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count_or_small(2000, 20); ++i) {
    const glm::dvec3 at = scene.frame.place(plane.origin + random.between(0.02, 0.98) * plane.x + random.between(0.02, 0.98) * plane.y);
    rays.push_back(ray_towards(at + 0.25 * n, at));
    rays.push_back(ray_towards(at - 0.25 * n, at));
  }
  const Shading shading = shade(scene, rays);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    EXPECT_LE(glm::length(unpacked(shading.normals[i]) + unpacked(shading.normals[i + 1])), 1e-5) << i;  // the hits differ by some u, times 4 steps
    EXPECT_GT(glm::length(unpacked(shading.normals[i]) - unpacked(shading.untilted[i])), 0.05);
  }
}

// Even where the frame's arithmetic would move it by some u.
TEST(normal_map_test, maps_that_say_nothing_leave_every_bit_of_the_normal) {
  Random random(12);
  World world;
  Material m = diffuse(0.5);
  m.normal_texture = add_constant(world, {0.5f, 0.5f, 1.0f});
  m.bump_texture = add_bitmap(world, 2, 2, 1, {0.3f, 0.3f, 0.3f, 0.3f});
  m.bump_scale = 10.0f;
  const Plane plane;
  add_plane(world, plane, m);
  const Scene scene = place_scene(world);
  const PlaneRays at = rays_at(plane, scene, count_or_small(1000, 20), random);
  const Shading shading = shade(scene, at.rays);
  EXPECT_EQ(std::memcmp(shading.normals.data(), shading.untilted.data(), at.rays.size() * sizeof(packed_float3)), 0);
}

TEST(normal_map_test, a_scene_times_a_power_of_two_has_the_same_bumps_bit_for_bit) {
  std::vector<packed_float3> normals[2];
  for (int i = 0; i < 2; ++i) {
    Random random(13);
    const double k = i ? 0x1p20 : 1.0;
    Plane plane;
    plane.origin *= k, plane.x *= k, plane.y *= k;
    World world;
    Material m = diffuse(0.5);
    m.bump_texture = add_bitmap(world, 8, 8, 1, random_numbers(64, 14));
    m.bump_scale = static_cast<float>(0.1 * k);
    add_plane(world, plane, m);
    const Scene scene = place_scene(world);
    normals[i] = shade(scene, rays_at(plane, scene, count_or_small(2000, 20), random).rays).normals;
  }
  EXPECT_EQ(std::memcmp(normals[0].data(), normals[1].data(), normals[0].size() * sizeof(packed_float3)), 0);
}
