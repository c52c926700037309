// What oclair tune finds on a plate of glass, whose transmittance is known with exact and with Schlick's reflectance.
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <numbers>

#include "../host/signals.h"
#include "../host/tune/tune.h"
#include "files.h"
#include "temporary_directory.h"

using namespace oclair;
using namespace oclair::tune;

namespace {

// Mean of the polarisations (Born and Wolf 1999, 1.5.2).
double exact_reflectance(double eta, double cosine) {
  const double g = std::sqrt(eta * eta - 1.0 + cosine * cosine);
  const double s = (cosine - g) / (cosine + g), p = (eta * eta * cosine - g) / (eta * eta * cosine + g);
  return 0.5 * (s * s + p * p);
}

// Schlick 1994, with the cosine in air: the same at both surfaces of a plate.
double schlick_reflectance(double eta, double cosine) {
  const double r0 = std::pow((eta - 1.0) / (eta + 1.0), 2.0);
  return r0 + (1.0 - r0) * std::pow(1.0 - cosine, 5.0);
}

// With all orders of reflection between the surfaces.
double transmittance(double reflectance) { return (1.0 - reflectance) / (1.0 + reflectance); }

// A plate of that index across the view at that angle, before a wall of radiance 1; what it reflects is black. The view is so narrow that the angle is
// the same everywhere.
std::string plate(double eta, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="-1"/><integer name="rr_depth" value="1000000"/></integrator>
  <sensor type="perspective"><float name="fov" value="0.01"/>
    <transform name="to_world"><lookat origin=")" + std::to_string(-std::sin(angle)) + ", 0, " + std::to_string(std::cos(angle)) +
         R"(" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/><rfilter type="box"/></film>
  </sensor>
  <shape type="cube"><bsdf type="dielectric"><float name="int_ior" value=")" + std::to_string(eta) + R"("/><float name="ext_ior" value="1"/></bsdf>
    <transform name="to_world"><scale x="2" y="2" z="0.005"/></transform></shape>
  <shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
    <transform name="to_world"><scale value="8"/><translate z="-0.1"/></transform>
    <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
</scene>
)";
}

}  // namespace

// Each interval may miss it once in 100 * (1 + settings) tries.
TEST(tune_image, schlicks_approximation_of_a_plate_has_the_bias_of_its_closed_form) {
  const TemporaryDirectory directory;
  struct Case {
    double eta, degrees, bias;
  };
  for (const auto& [eta, degrees, rounded] : {Case{1.5, 60.0, 0.039}, {1.5, 80.0, -0.051}, {2.42, 60.0, 0.028}, {2.42, 80.0, -0.137}}) {
    SCOPED_TRACE(std::to_string(eta) + " at " + std::to_string(degrees));
    const double cosine = std::cos(degrees * std::numbers::pi / 180.0);
    const double exact = transmittance(exact_reflectance(eta, cosine));
    const double expected = transmittance(schlick_reflectance(eta, cosine)) / exact - 1.0;
    EXPECT_NEAR(expected, rounded, 0.0006);
    put(directory / "plate.xml", plate(eta, degrees));
    Request request;
    request.scene = directory / "plate.xml";
    request.budget = 1e6;
    request.size = glm::uvec2(32, 32);
    const SignalHandlers handlers;
    const Result result = tune::tune(request, [](std::size_t done, std::size_t, const std::string&) {
      if (done == 1) raise(SIGINT);  // Fresnel's is the first, and there is no need of others
    });
    EXPECT_TRUE(result.interrupted);
    EXPECT_FALSE(result.not_measured.empty());
    ASSERT_EQ(result.rows.size(), 1u);
    const Row& row = result.rows[0];
    EXPECT_EQ(row.name, "fresnel=schlick");
    EXPECT_TRUE(row.estimates.bias.contains(expected)) << row.estimates.bias.low << " to " << row.estimates.bias.high << ", expected " << expected;
    EXPECT_LT(row.estimates.bias.high - row.estimates.bias.low, 0.5 * std::abs(expected));  // it is found, and with its sign
    EXPECT_GT(row.estimates.bias_bound, std::abs(expected));
    // All pixels see the same: the squared bias is that of the mean, less the hundredth in the weights.
    EXPECT_TRUE(row.estimates.squared_bias.contains(expected * expected / 1.01))
        << row.estimates.squared_bias.low << " to " << row.estimates.squared_bias.high;
    double mean = 0.0;
    for (const float value : result.picture) mean += value / static_cast<double>(result.picture.size());
    EXPECT_NEAR(mean, exact, 0.01);
  }
}
