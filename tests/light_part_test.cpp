// The parts of a triangle whose radiance is textured: their numbering, by brute force, and what the host makes of a texture.
#include "environment_maps.h"
#include "lights.h"
#include "../host/light_texture.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Part {
  float b1, b2, size;
};

std::vector<Part> parts_of(uint split) {
  std::vector<cl_uint> numbers(std::size_t{split} * split);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<cl_uint>(i);
  std::vector<Part> parts(numbers.size());
  run("light_test.cl", "part", numbers.size(), numbers, static_cast<cl_uint>(split), out(parts));
  return parts;
}

std::vector<cl_uint> part_at(const std::vector<float>& b1, const std::vector<float>& b2, uint split) {
  std::vector<cl_uint> parts(b1.size());
  run("light_test.cl", "part_at", b1.size(), b1, b2, static_cast<cl_uint>(split), out(parts));
  return parts;
}

// Barycentric coordinates of a point in a part: it is in there if all three are at least 0.
glm::dvec3 inside(const Part& p, double b1, double b2) {
  const double c1 = (b1 - p.b1) / p.size, c2 = (b2 - p.b2) / p.size;
  return {1 - c1 - c2, c1, c2};
}

double least(const glm::dvec3& v) { return std::min({v.x, v.y, v.z}); }

uint most_split() { return small_inputs() ? 5 : MAX_LIGHT_SPLIT; }

// A 2x2 square at z = 0.5 that faces down, with texture coordinates [0, 1]^2 and a texture of its radiance.
World textured_square(const WorldTexture& texture, double half = 0.5, double height = 0.5) {
  World world;
  add_frame_box(world);
  world.textures.push_back(texture);
  WorldShape& light = add_shape(world, diffuse(0.0), Sides::both, 1.0);
  light.radiance_texture = 1;
  add_quad(light.mesh, {-half, -half, height}, {0, 2 * half, 0}, {2 * half, 0, 0});
  light.mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  return world;
}

WorldTexture bitmap(std::shared_ptr<const Image> image, bool nearest) {
  WorldTexture texture;
  texture.image = std::move(image);
  texture.nearest = nearest;
  texture.wrap = WRAP_CLAMP;
  return texture;
}

// Irradiance at the origin of [x0, x1] x [y0, y1] at height h with radiance L(x, y): Gauss-Legendre, exact for our integrands.
double irradiance_of(double x0, double x1, double y0, double y1, double h, const std::function<double(double, double)>& radiance) {
  double sum = 0;
  for (const Node& x : gauss_legendre(40, x0, x1))
    for (const Node& y : gauss_legendre(40, y0, y1)) {
      const double d2 = x.x * x.x + y.x * y.x + h * h;
      sum += x.weight * y.weight * radiance(x.x, y.x) * h * h / (d2 * d2);
    }
  return sum;
}

}  // namespace

TEST(light_part_test, the_parts_are_equal_and_fill_the_triangle) {
  for (uint n = 1; n <= most_split(); ++n) {
    const std::vector<Part> parts = parts_of(n);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Part& p = parts[i];
      EXPECT_NEAR(std::abs(p.size), 1.0 / n, unit_roundoff / n);
      const TrianglePart host = triangle_part(static_cast<uint>(i), n);
      EXPECT_EQ(p.b1, static_cast<float>(host.b1));
      EXPECT_EQ(p.b2, static_cast<float>(host.b2));
      EXPECT_EQ(p.size, static_cast<float>(host.size));
      for (const glm::dvec2& corner : {glm::dvec2(p.b1, p.b2), {p.b1 + p.size, p.b2}, {p.b1, p.b2 + p.size}})
        EXPECT_GE(least({1 - corner.x - corner.y, corner.x, corner.y}), -4 * unit_roundoff);
      // No other part has its centre: equal areas that are disjoint fill the whole.
      std::size_t owners = 0;
      for (const Part& other : parts) owners += least(inside(other, p.b1 + p.size / 3.0, p.b2 + p.size / 3.0)) > 1e-3;
      EXPECT_EQ(owners, 1u) << n << " " << i;
    }
  }
}

// Every point of a part but those within rounding of its edge: the products with n round once, their differences not at all, the
// coordinates of the corners once.
TEST(light_part_test, the_part_of_a_point_is_the_one_in_which_it_lies) {
  Random random(1);
  for (uint n = 1; n <= most_split(); ++n) {
    const std::vector<Part> parts = parts_of(n);
    std::vector<float> b1, b2;
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (const glm::dvec2& c : {glm::dvec2(1 / 3.0), {1e-5, 1e-5}, {1 - 3e-5, 1e-5}, {1e-5, 1 - 3e-5}, {random.between(0.1, 0.5), random.between(0.1, 0.4)}}) {
        b1.push_back(static_cast<float>(parts[i].b1 + parts[i].size * c.x));
        b2.push_back(static_cast<float>(parts[i].b2 + parts[i].size * c.y));
        expected.push_back(i);
      }
    const auto found = part_at(b1, b2, n);
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k], expected[k]) << n << ": " << b1[k] << " " << b2[k];
  }
}

// On edges, corners, and outside by the rounding of a hit: a part that exists, and within rounding of the point.
TEST(light_part_test, points_on_edges_belong_to_a_part_beside_them) {
  Random random(2);
  for (uint n = 1; n <= most_split(); ++n) {
    const std::vector<Part> parts = parts_of(n);
    std::vector<float> b1 = {0, 1, 0, -1e-7f, 1.0000001f, 0.5f, 0.50000006f}, b2 = {0, 0, 1, 1.0000001f, -1e-7f, 0.5f, 0.5f};
    for (uint i = 0; i <= n; ++i)
      for (uint j = 0; i + j <= n; ++j) {
        b1.push_back(static_cast<float>(i) / n), b2.push_back(static_cast<float>(j) / n);
        const double x = random.unit();
        b1.push_back(static_cast<float>(i) / n), b2.push_back(static_cast<float>((1.0 - b1.back()) * x));
        b2.push_back(static_cast<float>(j) / n), b1.push_back(static_cast<float>((1.0 - b2.back()) * x));
        b1.push_back(static_cast<float>(static_cast<double>(i + j) / n * x)), b2.push_back(static_cast<float>(i + j) / n - b1.back());
      }
    const auto found = part_at(b1, b2, n);
    for (std::size_t k = 0; k < found.size(); ++k) {
      ASSERT_LT(found[k], n * n) << n << ": " << b1[k] << " " << b2[k];
      EXPECT_GE(least(inside(parts[found[k]], b1[k], b2[k])), -8 * unit_roundoff * n - 4e-7 * n) << n << ": " << b1[k] << " " << b2[k];
    }
  }
}

TEST(light_part_test, parts_follow_the_texture_and_are_bounded) {
  const auto lights_of = [](uint width, uint height) {
    return place_scene(textured_square(bitmap(random_image(width, height, 3), false)));
  };
  EXPECT_EQ(lights_of(1, 1).shapes[1].light_split, 1u);
  EXPECT_EQ(lights_of(1024, 1).shapes[1].light_split, 32u);
  const Scene middle = lights_of(8, 8);
  EXPECT_EQ(middle.shapes[1].light_split, 6u);  // 32 texels each
  ASSERT_EQ(middle.lights.size(), 72u);
  double area = 0;
  for (uint i = 0; i < 72; ++i) {
    const Light& light = middle.lights[i];
    EXPECT_EQ(light.part, i % 36);
    EXPECT_EQ(light.split, 6u);
    EXPECT_EQ(light.primitive, middle.shapes[1].first_triangle + i / 36);
    EXPECT_NEAR(0.5 * glm::length(glm::cross(unpacked(light.edge1), unpacked(light.edge2))), light.area, 4e-7 * light.area);
    area += light.area;
  }
  EXPECT_NEAR(area, 0.25, 1e-6);  // of 1 x 1, halved
  World many = textured_square(bitmap(random_image(64, 64, 3), false));
  for (int i = 0; i < (small_inputs() ? 10 : 2000); ++i) {
    add_quad(many.shapes[1].mesh, {-0.5, -0.5, 0.5}, {0, 1, 0}, {1, 0, 0});
    many.shapes[1].mesh.uvs.insert(many.shapes[1].mesh.uvs.end(), {{0, 0}, {0, 1}, {1, 1}, {1, 0}});
  }
  EXPECT_LE(place_scene(many).lights.size(), MAX_SHAPE_PARTS);
}

// Left half black, right half 1, hard between: the parts on the black side are hardly chosen, and what arrives is the right half's.
TEST(light_part_test, half_a_rectangle_lit_is_the_form_factor_of_that_half) {
  const auto halves = float_image(2, 1, [](uint x, uint) { return glm::dvec3(x); });
  const Scene scene = place_scene(textured_square(bitmap(halves, true)));
  const double exact = irradiance_of(0, 0.5, -0.5, 0.5, 0.5, [](double, double) { return 1.0; });
  // A part across the border is found by 1/64^2 of its points at most.
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}, count_or_small(128, 4)), exact, small_inputs() ? 0.3 * exact : 2e-3 * exact);
  double black = 0, white = 0;
  for (const Light& light : scene.lights) {
    const double x = light.position.x + (light.edge1.x + light.edge2.x) / 3.0;
    (x < 0 ? black : white) += light.probability;
  }
  EXPECT_LT(black, 0.3);
  EXPECT_GT(white, 0.7);
}

// Bilinear between two texels at 1/4 and 3/4: 0, a ramp, 1. The texture runs along +x: u = x + 1/2.
TEST(light_part_test, a_gradient_brings_its_quadrature) {
  const auto ramp = float_image(2, 1, [](uint x, uint) { return glm::dvec3(x * 3.0); });
  const Scene scene = place_scene(textured_square(bitmap(ramp, false)));
  const double exact = irradiance_of(-0.25, 0.25, -0.5, 0.5, 0.5, [](double x, double) { return 3.0 * (x + 0.25) / 0.5; }) +
                       irradiance_of(0.25, 0.5, -0.5, 0.5, 0.5, [](double, double) { return 3.0; });
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}, count_or_small(128, 4)), exact, small_inputs() ? 0.3 * exact : 1e-3 * exact);
}

// Many texels, so that each has its own parts: the sum over texels of form factors.
TEST(light_part_test, a_mosaic_brings_the_sum_of_its_tiles) {
  const auto image = random_image(6, 5, 4);
  const Scene scene = place_scene(textured_square(bitmap(image, true)));
  double exact = 0;
  for (uint y = 0; y < 5; ++y)
    for (uint x = 0; x < 6; ++x)
      exact += irradiance_of(x / 6.0 - 0.5, (x + 1) / 6.0 - 0.5, y / 5.0 - 0.5, (y + 1) / 5.0 - 0.5, 0.5, [&](double, double) { return texel_of(*image, x, y).x; });
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}, count_or_small(128, 4)), exact, small_inputs() ? 0.3 * exact : 3e-3 * exact);
}

// A sphere of radiance v around the origin, which sees it from inside: v runs from 0 at +z to 1 at -z.
TEST(light_part_test, a_textured_sphere_brings_its_texture_to_its_middle) {
  const uint n = 64;
  World world;
  add_frame_box(world);
  world.textures.push_back(bitmap(float_image(1, n, [](uint, uint y) { return glm::dvec3((y + 0.5) / n); }), false));
  WorldShape& sphere = add_shape(world, diffuse(0.0), Sides::both, 1.0);
  sphere.geometry = Geometry::sphere;
  sphere.to_world = glm::dmat4(0.8);
  sphere.to_world[3][3] = 1;
  sphere.flip_normals = true;
  sphere.radiance_texture = 1;
  const Scene scene = place_scene(world);
  // Integral over the upper hemisphere of v cos, v = theta / pi: 2 pi int theta / pi sin cos = pi / 4; lower: pi - pi / 4.
  const double upper = irradiance(scene, {0, 0, 0}, {0, 0, 1}, count_or_small(512, 4)), lower = irradiance(scene, {0, 0, 0}, {0, 0, -1}, count_or_small(512, 4));
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(upper, pi / 4, small_inputs() ? 0.4 : 1e-3);
  EXPECT_NEAR(lower, 3 * pi / 4, small_inputs() ? 0.4 : 1e-3);
  EXPECT_NEAR(scene.lights[0].radiance.x, 0.5, 1e-3);  // the mean
}

TEST(light_part_test, a_black_texture_is_no_light) {
  const Scene scene = place_scene(textured_square(bitmap(float_image(3, 3, [](uint, uint) { return glm::dvec3(0.0); }), false)));
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.shapes[1].first_light, NONE);
}
