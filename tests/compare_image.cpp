// `oclair compare` of renders: noise is no difference, half a percent of light is one.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "encoders.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

namespace fs = std::filesystem;

const fs::path scene = fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes" / "cornell.xml";

void render(const fs::path& from, const fs::path& image, int seed, int spp, const std::string& size,
            const std::string& sampler) {
  const ProgramResult result = run_oclair({"render", from.string(), "-o", image.string(), "--seed", std::to_string(seed),
                                           "--spp", std::to_string(spp), "--size", size, "--sampler", sampler});
  ASSERT_EQ(result.exit, 0) << result.err;
}

}  // namespace

// Ten comparisons at 2e-6 each.
TEST(compare_image, renders_of_other_seeds_and_numbers_of_samples_are_not_different) {
  const TemporaryDirectory directory;
  const fs::path a = directory / "a.exr", b = directory / "b.exr";
  int seed = 1;
  for (const char* sampler : {"sobol", "independent"})
    for (const int spp : {32, 32, 64, 128, 160}) {
      render(scene, a, seed++, 32, "24x24", sampler);
      render(scene, b, seed++, spp, "24x24", sampler);
      const ProgramResult result = run_oclair({"compare", a.string(), b.string(), "--alpha", "2e-6"});
      EXPECT_EQ(result.exit, 0) << sampler << ", " << spp << " samples\n" << result.out;
      EXPECT_NE(result.out.find("false-alarm rate at most 2e-06"), std::string::npos) << result.out;
    }
}

// A lamp that is not seen, facing away, 10^10 times as bright as the wall that is: it sets the scale of the film, so standard errors do
// not resolve the noise of the wall's gradient.
TEST(compare_image, noise_far_below_the_brightest_lamp_is_no_difference) {
  const TemporaryDirectory directory;
  const fs::path wall = directory / "wall.xml", a = directory / "a.exr", b = directory / "b.exr";
  put(directory / "gradient.png", oclair::test::png_bytes(2, 2, PNG_COLOR_TYPE_GRAY, 8, {60, 90, 150, 200}));
  put(wall, R"(<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="2"/></integrator>
    <sensor type="perspective"><float name="fov" value="30"/>
      <transform name="to_world"><lookat origin="0,0,2" target="0,0,0" up="0,1,0"/></transform>
      <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film></sensor>
    <shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
      <emitter type="area"><texture type="bitmap" name="radiance"><string name="filename" value="gradient.png"/></texture></emitter></shape>
    <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate z="-1"/></transform>
      <emitter type="area"><rgb name="radiance" value="1e10"/></emitter></shape>
  </scene>)");
  render(wall, a, 1, 512, "16x16", "sobol");
  render(wall, b, 2, 512, "16x16", "sobol");
  const ProgramResult result = run_oclair({"compare", a.string(), b.string(), "--alpha", "2e-6", "--json", "-"});
  EXPECT_EQ(result.exit, 0) << result.out << result.err;
  EXPECT_GT(nlohmann::json::parse(result.out).at("difference").at("mse"), 0.0);
}

// All light comes from one lamp. `weighted` sees the whole picture, `pixel` those in which the lamp itself is seen, without
// noise.
TEST(compare_image, a_lamp_that_is_half_a_percent_brighter_is_found) {
  const TemporaryDirectory directory;
  const fs::path brighter = directory / "brighter.xml", a = directory / "a.exr", b = directory / "b.exr";
  std::string text = content(scene);
  const std::string radiance = "\"8, 6.6, 4.4\"";
  ASSERT_NE(text.find(radiance), std::string::npos);
  put(brighter, text.replace(text.find(radiance), radiance.size(), "\"8.04, 6.633, 4.422\""));
  render(scene, a, 1, 512, "64x64", "sobol");
  render(brighter, b, 2, 512, "64x64", "sobol");
  const ProgramResult result = run_oclair({"compare", a.string(), b.string(), "--json", "-"});
  EXPECT_EQ(result.exit, 7) << result.err;
  const auto tests = nlohmann::json::parse(result.out).at("equality").at("tests");
  EXPECT_EQ(tests.at(1).at("name"), "weighted");
  EXPECT_LT(tests.at(1).at("p"), 1e-3);
  EXPECT_LT(tests.at(1).at("statistic"), 0.0);
  EXPECT_EQ(tests.at(3).at("name"), "pixel");
  EXPECT_LT(tests.at(3).at("p"), 1e-6);
}
