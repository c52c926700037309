// Blends, opacity and the textures of a material at one point.
#include "random.h"
#include "statistics.h"
#include "textured.h"

using namespace oclair;
using namespace oclair::test;

namespace {

using Uv = std::array<float, 2>;

// The materials and textures of a world as the kernels see them. The first material is what the one triangle is made of.
Scene placed(const World& world) {
  World w = world;
  WorldShape& shape = w.shapes.emplace_back();
  add_triangle(shape.mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  shape.material_front = 0;
  return place_scene(w);
}

std::vector<cl_uint> selected(const Scene& scene, uint index, const std::vector<Uv>& uvs, const std::vector<cl_uint>& bits) {
  std::vector<cl_uint> which(bits.size());
  run("material_test.cl", "selected", bits.size(), scene.materials, scene.textures, scene.texels, index, uvs, bits, out(which));
  return which;
}

std::vector<cl_uint> random_bits(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<cl_uint> bits(count);
  for (cl_uint& b : bits) b = static_cast<cl_uint>(random.engine());
  return bits;
}

// Leaves are told apart by their albedo: they are placed in another order.
Material blend(double weight, uint first, uint second) {
  Material m{};
  m.kind = MATERIAL_BLEND;
  m.weight = static_cast<float>(weight);
  m.first = first;
  m.second = second;
  return m;
}

// The index of the blend, which is placed behind its leaves.
uint top(const Scene& scene) { return scene.shapes[0].material_front; }

float albedo(const Scene& scene, cl_uint which) { return scene.materials[which].reflectance.x; }

// How many of the choices came down to that albedo.
double count_of(const Scene& scene, const std::vector<cl_uint>& which, double value) {
  return static_cast<double>(std::count_if(which.begin(), which.end(), [&](cl_uint w) { return albedo(scene, w) == static_cast<float>(value); }));
}

World two_leaves(double weight) {
  World world;
  world.materials = {blend(weight, 1, 2), diffuse(0.25), diffuse(0.75)};
  return world;
}

struct LookedUp {
  std::vector<float> transparencies;
  std::vector<Material> materials;
};

LookedUp looked_up(const Scene& scene, const std::vector<Uv>& uvs) {
  LookedUp result{std::vector<float>(scene.materials.size()), std::vector<Material>(scene.materials.size())};
  run("material_test.cl", "looked_up", scene.materials.size(), scene.materials, scene.textures, scene.texels, uvs, out(result.transparencies), out(result.materials));
  return result;
}

}  // namespace

TEST(material_test, a_plain_material_is_itself) {
  World world;
  world.materials = {diffuse(0.3)};
  const Scene scene = placed(world);
  for (const cl_uint w : selected(scene, 0, std::vector<Uv>(16), random_bits(16, 1))) EXPECT_EQ(w, 0u);
}

TEST(material_test, weights_0_and_1_choose_one_of_two_always) {
  for (const double weight : {0.0, 1.0}) {
    const Scene scene = placed(two_leaves(weight));
    std::vector<cl_uint> bits = random_bits(count_or_small(100000, 60), 2);
    bits[0] = 0;
    bits[1] = 0xffffffffu;
    EXPECT_EQ(count_of(scene, selected(scene, top(scene), std::vector<Uv>(bits.size()), bits), weight == 1.0 ? 0.75 : 0.25), static_cast<double>(bits.size()));
  }
}

TEST(material_test, the_second_is_chosen_as_often_as_the_weight_says) {
  const std::size_t n = count_or_small(1000000, 100);
  for (const double weight : {1e-3, 0.25, 0.5, 0.9}) {
    const Scene scene = placed(two_leaves(weight));
    const double second = count_of(scene, selected(scene, top(scene), std::vector<Uv>(n), random_bits(n, 3)), 0.75), total = static_cast<double>(n);
    EXPECT_LE(std::abs(second - weight * total), sidak_z * std::sqrt(total * weight * (1 - weight)) + 1) << weight;
  }
}

// Four leaves in a tree of three blends: each as often as the product of its weights, so the choices are independent.
TEST(material_test, nested_blends_choose_independently) {
  World world;
  world.materials = {blend(0.3, 1, 2), blend(0.6, 3, 4), blend(0.2, 5, 6), diffuse(0.1), diffuse(0.2), diffuse(0.3), diffuse(0.4)};
  const Scene scene = placed(world);
  const std::size_t n = count_or_small(1000000, 200);
  const std::vector<cl_uint> which = selected(scene, top(scene), std::vector<Uv>(n), random_bits(n, 4));
  std::vector<double> observed;
  for (const double a : {0.1, 0.2, 0.3, 0.4}) observed.push_back(count_of(scene, which, a));
  const double total = static_cast<double>(n);
  const auto f = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  const double w = f(0.3), a = f(0.6), b = f(0.2);
  EXPECT_GE(chi_square_test(observed, {total * (1 - w) * (1 - a), total * (1 - w) * a, total * w * (1 - b), total * w * b}), false_alarm);
}

TEST(material_test, a_weight_texture_is_looked_up_and_counts_as_0_or_1_beyond) {
  World world = two_leaves(0.5);
  world.materials[0].weight_texture = add_bitmap(world, 4, 1, 1, {-3.0f, 0.25f, 7.0f, std::numeric_limits<float>::quiet_NaN()});
  world.textures[0].nearest = true;
  const Scene scene = placed(world);
  const std::size_t n = count_or_small(400000, 100);
  const std::vector<double> expected = {0.0, 0.25, 1.0, 0.0};  // NaN: the first
  for (std::size_t i = 0; i < 4; ++i) {
    const std::vector<Uv> uvs(n, {0.125f + 0.25f * static_cast<float>(i), 0.5f});
    const double second = count_of(scene, selected(scene, top(scene), uvs, random_bits(n, 5)), 0.75), total = static_cast<double>(n);
    EXPECT_LE(std::abs(second - expected[i] * total), sidak_z * std::sqrt(total * expected[i] * (1 - expected[i]))) << i;
  }
}

// A colour counts by its luminance: Rec. ITU-R BT.709.
TEST(material_test, transparency_is_one_minus_opacity_within_0_and_1) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  struct Row { std::vector<float> opacity; double transparency; };
  const std::vector<Row> table = {{{0.0f}, 1}, {{0.25f}, 0.75}, {{1.0f}, 0}, {{7.0f}, 0}, {{-7.0f}, 1}, {{inf}, 0}, {{-inf}, 1}, {{nan}, 0}, {{0.5f, 0.25f, 1.0f}, 1 - (0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722)}};
  for (const Row& row : table) {
    World world;
    world.materials = {diffuse(0.5)};
    world.materials[0].opacity_texture = add_constant(world, row.opacity);
    world.textures[0].nearest = true;  // interpolation makes NaN of infinities
    EXPECT_NEAR(looked_up(placed(world), {{0.3f, 0.4f}}).transparencies[0], row.transparency, 4 * unit_roundoff) << row.opacity[0];
  }
  World world;
  world.materials = {diffuse(0.5)};
  world.materials[0].transparency = 0.3f;
  EXPECT_EQ(looked_up(placed(world), {{0.3f, 0.4f}}).transparencies[0], 0.3f);
}

TEST(material_test, reflectances_of_textures_lie_in_0_and_1_and_take_the_place_of_the_constants) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  struct Row { std::vector<float> said, meant; };
  const std::vector<Row> table = {{{0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}}, {{-1, 2, nan}, {0, 1, 0}}, {{inf, -inf, 1}, {1, 0, 1}}, {{nan}, {0, 0, 0}}, {{0.5f}, {0.5f, 0.5f, 0.5f}}};
  for (const Row& row : table) {
    World world;
    world.materials = {dielectric(1.5)};
    world.materials[0].reflectance_texture = add_constant(world, row.said);
    world.textures[0].nearest = true;
    LookedUp m = looked_up(placed(world), {{0.3f, 0.4f}});
    const auto expect = [&](const packed_float3& v) {
      EXPECT_EQ(v.x, row.meant[0]);
      EXPECT_EQ(v.y, row.meant[1]);
      EXPECT_EQ(v.z, row.meant[2]);
    };
    expect(m.materials[0].reflectance);
    EXPECT_EQ(m.materials[0].transmittance.x, 1.0f);
    std::swap(world.materials[0].reflectance_texture, world.materials[0].transmittance_texture);
    m = looked_up(placed(world), {{0.3f, 0.4f}});
    expect(m.materials[0].transmittance);
    EXPECT_EQ(m.materials[0].reflectance.x, 1.0f);
    EXPECT_EQ(m.materials[0].eta, 1.5f);
  }
}

// The constant is its factor: at most sqrt(2), alpha = 2, for Oren and Nayar, 1 for Disney.
TEST(material_test, roughness_of_a_texture_is_scaled_and_stays_in_the_range_of_its_model) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), factor = 0.70710678f, sigma_of_2 = 1.41421356f;
  for (const auto& [kind, most] : {std::pair{MATERIAL_OREN_NAYAR, sigma_of_2}, {MATERIAL_OREN_NAYAR_FAST, sigma_of_2}, {MATERIAL_DISNEY, 1.0f}})
    for (const auto& [said, meant] : {std::pair{0.5f, 0.5f * factor}, {0.0f, 0.0f}, {-1.0f, 0.0f}, {100.0f, most}, {nan, 0.0f}}) {
      World world;
      world.materials = {diffuse(0.5)};
      world.materials[0].kind = kind;
      world.materials[0].roughness = factor;
      world.materials[0].roughness_texture = add_constant(world, {said});
      world.textures[0].nearest = true;
      EXPECT_EQ(looked_up(placed(world), {{0.3f, 0.4f}}).materials[0].roughness, meant) << kind << " " << said;
    }
}

// Sixty blends, each of the one before with itself: 2^60 ways down, but one leaf.
TEST(material_test, a_tower_of_shared_blends_is_placed_and_walked_at_once) {
  World world;
  world.materials = {blend(0.5, 1, 1)};
  for (uint i = 1; i < 60; ++i) world.materials.push_back(blend(0.5, i + 1, i + 1));
  world.materials.push_back(diffuse(0.5));
  const Scene scene = placed(world);
  EXPECT_EQ(scene.materials.size(), 61u);
  EXPECT_EQ(count_of(scene, selected(scene, top(scene), std::vector<Uv>(64), random_bits(64, 6)), 0.5), 64.0);
}
