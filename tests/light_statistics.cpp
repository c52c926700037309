// Directions and densities of light samples. Every sampled direction is followed in double to the light; uniform by area there (or
// by solid angle in the cone of a sphere) is what the density says, so that the expected counts are exact.
#include "extremes.h"
#include "lights.h"
#include "statistics.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

const double pi = std::acos(-1.0);

struct Place {
  bool hit;
  double a, b;      // uniform in [0, 1)^2 if the light is sampled uniformly
  double t;         // canonical
  double cosine;    // at the light, on its front
  double pdf;       // closed form, without the selection
};

double wrap(double y, double x) { return std::atan2(y, x) / (2 * pi) + 0.5; }

Place on_triangle(const Light& light, const glm::dvec3& from, const glm::dvec3& w) {
  const glm::dvec3 v0 = unpacked(light.position), e1 = unpacked(light.edge1), e2 = unpacked(light.edge2), n = glm::cross(e1, e2);
  const double t = glm::dot(v0 - from, n) / glm::dot(w, n);
  const glm::dvec3 p = from + t * w - v0;
  const double b1 = glm::dot(glm::cross(p, e2), n) / glm::dot(n, n), b2 = glm::dot(glm::cross(e1, p), n) / glm::dot(n, n);
  // Uniform barycentric coordinates to the square: b0 = 1 - sqrt(a) has density 2 (1 - b0).
  const double rest = b1 + b2, cosine = -glm::dot(w, n) / glm::length(n), slack = 1e-5;
  return {t > 0 && b1 > -slack && b2 > -slack && rest < 1 + slack, rest * rest, b2 / rest, t, cosine, t * t / (0.5 * glm::length(n) * std::abs(cosine))};
}

// The root of the sphere or cylinder on the side that is seen: the front.
Place on_quadric(const Quadric& q, const glm::dvec3& from, const glm::dvec3& w) {
  const glm::dvec3 x = unpacked(q.axis_x), y = unpacked(q.axis_y), z = unpacked(q.axis_z), d = from - unpacked(q.center);
  const glm::dvec3 o(glm::dot(x, d), glm::dot(y, d), glm::dot(z, d)), v(glm::dot(x, w), glm::dot(y, w), glm::dot(z, w));
  double t;
  if (q.kind == QUADRIC_DISK) {
    t = -o.z / v.z;
  } else {
    const glm::dvec3 across = q.kind == QUADRIC_CYLINDER ? glm::dvec3(1, 1, 0) : glm::dvec3(1);
    const double a = glm::dot(v * across, v * across), b = glm::dot(o * across, v * across), c = glm::dot(o * across, o * across) - 1;
    const double root = std::sqrt(std::max(b * b - a * c, 0.0));
    t = (-b + (q.flip > 0 ? -root : root)) / a;
  }
  const glm::dvec3 p = o + t * v;
  glm::dvec3 n = q.kind == QUADRIC_DISK ? z : q.kind == QUADRIC_SPHERE ? x * p.x + y * p.y + z * p.z : x * p.x + y * p.y;
  n = glm::normalize(n) * static_cast<double>(q.flip);
  const double cosine = -glm::dot(w, n), r2 = p.x * p.x + p.y * p.y, slack = 1e-4;
  Place place{t > 0, 0, 0, t, cosine, t * t / (static_cast<double>(q.area) * std::abs(cosine))};
  place.b = wrap(p.y, p.x);
  if (q.kind == QUADRIC_SPHERE) place.a = 0.5 * (p.z + 1);
  if (q.kind == QUADRIC_DISK) place.a = r2, place.hit &= r2 < 1 + slack;
  if (q.kind == QUADRIC_CYLINDER) place.a = p.z, place.hit &= p.z > -slack && p.z < 1 + slack;
  return place;
}

// The cone under which a sphere is seen from outside.
Place in_cone(const Quadric& q, const glm::dvec3& from, const glm::dvec3& w) {
  Place place = on_quadric(q, from, w);
  const glm::dvec3 d = unpacked(q.center) - from, axis = glm::normalize(d), x = glm::normalize(glm::cross(axis, glm::dvec3(0.3, 0.5, 0.8))), y = glm::cross(axis, x);
  const double r = 1 / glm::length(unpacked(q.axis_x)), sin2 = r * r / glm::dot(d, d), cap = sin2 / (1 + std::sqrt(1 - sin2));
  const double side2 = std::pow(glm::dot(w, x), 2) + std::pow(glm::dot(w, y), 2);
  const double one_minus_cos = side2 / (1 + glm::dot(w, axis));
  place.a = one_minus_cos / cap;
  place.b = wrap(glm::dot(w, y), glm::dot(w, x));
  place.pdf = 1 / (2 * pi * cap);
  // 2 u of direction over the half angle, doubled by squaring: a cone of 3e-4 rad is known to 1e-3.
  place.hit = place.a < 1 + 1e-5 + 8 * unit_roundoff / std::sqrt(sin2);
  return place;
}

struct View {
  const char* name;
  WorldShape shape;
  glm::dvec3 from;  // canonical
  bool cone;
};

WorldShape quadric(Geometry geometry, double r, double h, bool flip, const glm::dvec3& center) {
  WorldShape shape;
  shape.geometry = geometry;
  shape.flip_normals = flip;
  const glm::dvec3 x = glm::normalize(glm::dvec3(1, 2, 2)), y = glm::normalize(glm::dvec3(2, 1, -2)), z = glm::normalize(glm::dvec3(-2, 2, -1));
  shape.to_world = glm::dmat4(glm::dvec4(r * x, 0), glm::dvec4(r * y, 0), glm::dvec4(h * z, 0), glm::dvec4(center, 1));
  return shape;
}

std::vector<View> views() {
  WorldShape triangle;
  add_triangle(triangle.mesh, {.2, .1, .8}, {.4, .9, .5}, {.9, .3, .8});
  return {{"triangle", triangle, {0, 0, 0}, false},
          {"sphere from outside", quadric(Geometry::sphere, 0.3, 0.3, false, {0.2, 0.1, 0.6}), {-0.2, 0, 0}, true},
          {"sphere from near", quadric(Geometry::sphere, 0.3, 0.3, false, {0.2, 0.1, 0.6}), {0.1, 0.05, 0.3 - 0.151}, true},
          {"sphere from far", quadric(Geometry::sphere, 1e-3, 1e-3, false, {0.9, 0.9, 0.9}), {-0.4, -0.45, -0.4}, true},
          {"sphere from inside", quadric(Geometry::sphere, 0.5, 0.5, true, {0.2, 0.1, 0.3}), {0.15, 0.1, 0.1}, false},
          {"disk", quadric(Geometry::disk, 0.4, 0.4, false, {0.2, 0.1, 0.6}), {-0.3, 0.2, 0.1}, false},
          {"cylinder from inside", quadric(Geometry::cylinder, 0.4, 0.7, true, {0.2, 0.1, 0.1}), {0.05, 0.08, 0.04}, false}};
}

Scene lit(const View& view) {
  World world;
  add_frame_box(world);
  WorldShape& shape = add_shape(world, diffuse(0.0), Sides::both, 2.0);
  const uint front = shape.material_front, back = shape.material_back;
  shape = view.shape;
  shape.material_front = front, shape.material_back = back;
  shape.radiance = glm::dvec3(2.0);
  world.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(0.1), {0, 0, -1}});  // so that the selection has a probability below 1
  return place_scene(world);
}

Place place_of(const Scene& scene, const View& view, const glm::dvec3& w) {
  if (scene.lights[0].kind == LIGHT_TRIANGLE) return on_triangle(scene.lights[0], view.from, w);
  return view.cone ? in_cone(scene.quadrics[0], view.from, w) : on_quadric(scene.quadrics[0], view.from, w);
}

}  // namespace

TEST(light_statistics, sampled_directions_are_uniform_on_the_light) {
  for (const View& view : views()) {
    const Scene scene = lit(view);
    const std::vector<LightResult> samples = sample_light(scene, 0, view.from, random_squares(count_or_small(1000000, 2000), 7));
    constexpr int n = 10;
    std::vector<double> counts(n * n);
    std::size_t outside = 0;
    for (const LightResult& s : samples) {
      const Place p = place_of(scene, view, unpacked(s.direction));
      outside += !p.hit;
      const auto bin = [](double x) { return std::clamp(static_cast<int>(x * n), 0, n - 1); };
      counts[bin(p.a) * n + bin(p.b)] += 1;
    }
    EXPECT_EQ(outside, 0u) << view.name;
    EXPECT_GE(uniformity_test(counts), false_alarm) << view.name;
  }
}

// pdf: d^2 / (A cos), or the uniform density of the cone, times the probability of the light. Twelve roundings and the error of the
// position, some u of the distance, over the distance; the cosine errs by some u, relatively the more the more grazing.
TEST(light_statistics, weight_times_density_is_the_radiance_and_the_density_is_the_closed_form) {
  for (const View& view : views()) {
    const Scene scene = lit(view);
    const float p = scene.lights[0].probability;
    ASSERT_LT(p, 1.0f);
    const std::vector<LightResult> samples = sample_light(scene, 0, view.from, random_squares(count_or_small(50000, 100), 8));
    std::vector<float> t, cosine, pdf(samples.size());
    std::vector<Place> places;
    for (const LightResult& s : samples) {
      places.push_back(place_of(scene, view, unpacked(s.direction)));
      t.push_back(static_cast<float>(places.back().t));
      cosine.push_back(static_cast<float>(places.back().cosine));
    }
    run("light_test.cl", "density", samples.size(), scene.lights, scene.quadrics, std::vector<cl_uint>(samples.size(), 0),
        std::vector<packed_float3>(samples.size(), packed(view.from)), t, cosine, out(pdf));
    std::size_t seen = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const LightResult& s = samples[i];
      EXPECT_EQ(s.primitive, scene.lights[0].primitive);
      EXPECT_NEAR(glm::length(unpacked(s.direction)), 1.0, 6 * unit_roundoff);
      if (!view.cone && places[i].cosine < 0.01) continue;
      const double exact = places[i].pdf * static_cast<double>(p);
      const double tolerance = view.cone ? 24 * unit_roundoff : 24 * unit_roundoff / places[i].cosine;
      EXPECT_NEAR(s.pdf, exact, tolerance * exact) << view.name;
      EXPECT_NEAR(pdf[i], exact, tolerance * exact) << view.name;
      EXPECT_NEAR(s.weight.x * s.pdf, 2.0, tolerance * 2.0) << view.name;
      // The shadow ray ends on the light: within the light's own error, 2e-6, and for a sphere by its rim less sharply.
      EXPECT_NEAR(s.distance, places[i].t, view.cone && places[i].cosine < 0.05 ? 1e-2 : 1e-5) << view.name;
      ++seen;
    }
    EXPECT_GT(seen, samples.size() / 2) << view.name;
  }
}

// A density that integrates to the probability: the mean of 1/pdf over the samples is the solid angle, closed form.
TEST(light_statistics, the_mean_of_one_over_the_density_is_the_solid_angle) {
  const View view = views()[0];
  const Scene scene = lit(view);
  double sum = 0, squares = 0;
  const std::vector<LightResult> samples = sample_light(scene, 0, view.from, random_squares(count_or_small(1000000, 1000), 9));
  for (const LightResult& s : samples) {
    const double x = scene.lights[0].probability / static_cast<double>(s.pdf);
    sum += x;
    squares += x * x;
  }
  const double n = static_cast<double>(samples.size()), mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
  // Van Oosterom and Strackee 1983.
  const glm::dvec3 a = unpacked(scene.lights[0].position) - view.from, b = a + unpacked(scene.lights[0].edge1), c = a + unpacked(scene.lights[0].edge2);
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double omega = 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  EXPECT_NEAR(mean, omega, sidak_z * error);
}

// Shadow rays to a light that nothing hides, through the whole traversal.
TEST(light_statistics, no_light_shadows_itself) {
  for (const View& view : views()) {
    const Scene scene = lit(view);
    std::vector<Ray> rays;
    for (const LightResult& s : sample_light(scene, 0, view.from, random_squares(count_or_small(200000, 100), 10)))
      if (s.weight.x > 0.0f) rays.push_back({packed(view.from), s.distance, s.direction, NONE, s.primitive, 0.0f, 0});
    const std::vector<cl_uint> blocked = trace_any(scene, build_bvh(scene, 8), rays);
    EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1u), 0) << view.name << " of " << rays.size();
  }
}

// Extreme X24: half of 100 000 triangles have no area, the first and the last among them. 1e7 draws choose lights in proportion to
// their areas, in 1000 groups of neighbours, and the flux is that of the triangles that have an area.
TEST(light_statistics, a_mesh_of_100000_triangles_is_chosen_by_area_and_never_where_it_has_none) {
  Random random(12);
  World world;
  add_frame_box(world);
  WorldShape& shape = add_shape(world, diffuse(0.0), Sides::both, 1.0);
  const std::size_t n = count_or_small(50000, 200);
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 a = random.in_cube(0.9), b = a + random.in_cube(0.1) * random.unit(), c = a + random.in_cube(0.1) * random.unit();
    if (i % 2) add_triangle(shape.mesh, a, b, b);
    else add_triangle(shape.mesh, a, a, a);
    add_triangle(shape.mesh, a, b, c);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  add_triangle(shape.mesh, {0, 0, 0}, {0.3, 0, 0}, {0.6, 0, 0});
  world.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(area / 4), {0, 0, -1}});  // canonical area: a quarter
  const Scene scene = place_scene(world);
  ASSERT_EQ(scene.lights.size(), n + 1);
  // Flux pi A L of the mesh against pi 3 E of the directional light; vertices rounded to float32.
  EXPECT_NEAR(scene.lights.back().probability, 3.0 / 4.0, 1e-5);

  const std::size_t draws = count_or_small(10000000, 2000), groups = count_or_small(1000, 10);
  std::vector<cl_uint> bits(draws), which(draws);
  for (cl_uint& b : bits) b = static_cast<cl_uint>(random.engine());
  bits[0] = 0u, bits[1] = 0xffffffffu;
  run("light_test.cl", "choose", draws, scene.light_cdf, static_cast<cl_uint>(scene.light_cdf.size()), bits, out(which));
  EXPECT_EQ(which[0], 0u);
  EXPECT_EQ(which[1], n);
  std::vector<double> counts(groups + 1), expected(groups + 1);
  for (std::size_t i = 0; i <= n; ++i) {
    const Light& light = scene.lights[i];
    EXPECT_TRUE(i == n || light.area > 0.0f);
    const double flux = i < n ? light.area : 3.0 * area / 4;
    expected[i * groups / n] += flux;
  }
  for (const cl_uint i : which) counts[i * groups / n] += 1;
  double total = 0.0;
  for (const double e : expected) total += e;
  for (double& e : expected) e *= static_cast<double>(draws) / total;
  EXPECT_GE(chi_square_test(counts, expected), false_alarm);
  record_law("X24");
}
