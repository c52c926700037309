// A textured surface through the film: a diffuse square, lit evenly from around, shows its albedo times that light.
#include <cstring>
#include <memory>
#include <span>

#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double light = 0.5;

// The square [-1, 1]^2 fills the film; u runs to the right and v down, as pixels do.
World square(uint size) {
  World world;
  Mesh& mesh = add_shape(world, diffuse(0.0), Sides::front).mesh;
  add_quad(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  world.lights.push_back({LIGHT_CONSTANT, glm::dvec3(light), {}});
  world.integrator.max_depth = 2;
  look(world, {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.25, size, size);
  world.materials[0].reflectance_texture = 1;
  return world;
}

WorldTexture float_bitmap(uint width, uint height, const std::vector<float>& values) {
  auto image = std::make_shared<Image>();
  image->width = width;
  image->height = height;
  image->format = TEXEL_FLOAT;
  const auto bytes = std::as_bytes(std::span(values));
  image->texels.assign(bytes.begin(), bytes.end());
  WorldTexture texture;
  texture.image = image;
  return texture;
}

// Nothing but the square's own light is seen: each sample of a pixel is light * albedo or 0, by whether its one light sample
// goes up.
std::vector<float> some_albedos(std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(0.1f + 0.8f * static_cast<float>(i * 37 % 101) / 100.0f);
  return values;
}

}  // namespace

// Each pixel shows one texel. The light is sampled by two ways, weighted: no sample exceeds twice its mean by much, so that
// the standard error of n samples is below mean * sqrt(3 / n); 4.27 of those.
TEST(texture_image, nearest_shows_the_texels_as_they_are) {
  const uint size = 8, samples = 1024;
  World world = square(size);
  const auto values = some_albedos(size * size * 3);
  world.textures.push_back(float_bitmap(size, size, values));
  world.textures[0].nearest = true;
  const Film film = render_full(world, samples);
  for (std::size_t i = 0; i < size * size; ++i) {
    const auto rgb = pixel_mean(film, i);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(rgb[c], light * values[3 * i + c], 4.27 * light * values[3 * i + c] * std::sqrt(3.0 / samples))
          << "pixel " << i;
    EXPECT_NEAR(rgb[1] * values[3 * i], rgb[0] * values[3 * i + 1], 1e-6) << "channels of one sample see one light";
  }
}

// Between the centres of the four texels the mean over a pixel of a product of two linear functions is its value at the
// pixel's centre.
TEST(texture_image, bilinear_runs_from_texel_to_texel) {
  const uint size = 8, samples = 1024;
  World world = square(size);
  const std::vector<float> corner = {0.1f, 0.9f, 0.5f, 0.3f};
  std::vector<float> values;
  for (const float v : corner) values.insert(values.end(), {v, v, v});
  world.textures.push_back(float_bitmap(2, 2, values));
  world.textures[0].wrap = WRAP_CLAMP;
  const Film film = render_full(world, samples);
  for (uint y = 2; y < 6; ++y)
    for (uint x = 2; x < 6; ++x) {
      const double a = (x + 0.5) / 4 - 0.5, b = (y + 0.5) / 4 - 0.5;
      const double albedo = (1 - b) * ((1 - a) * corner[0] + a * corner[1]) + b * ((1 - a) * corner[2] + a * corner[3]);
      EXPECT_NEAR(pixel_mean(film, y * size + x)[0], light * albedo, 4.27 * light * albedo * std::sqrt(3.0 / samples))
          << x << " " << y;
    }
}

// An image of one grey is a plain colour: the same bits of every pixel.
TEST(texture_image, a_texture_of_one_value_renders_as_that_colour) {
  World textured = square(16), plain = square(16);
  const float albedo = 0.375f;
  textured.textures.push_back(float_bitmap(1, 1, {albedo, albedo, albedo}));
  plain.materials[0] = diffuse(albedo);
  const Film a = render_full(textured, 16), b = render_full(plain, 16);
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    EXPECT_EQ(std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(FilmPixel)), 0) << i;
}

// The attribute of a vertex is 1 there and 0 elsewhere: the mean of the albedo over the square is that of the barycentric
// coordinate.
TEST(texture_image, vertex_attributes_are_interpolated_over_the_square) {
  World world = square(16);
  world.shapes[0].mesh.attributes.push_back({"vertex_heat", false, 1, {0.0f, 0.0f, 1.0f, 0.0f}});
  WorldTexture texture;
  texture.attribute = "vertex_heat";
  world.textures.push_back(texture);
  const auto mean = image_mean(render_full(world, 64));
  EXPECT_NEAR(mean.mean, light / 3, 4.27 * light / 3 * std::sqrt(6.0 / (256 * 64)));
}
