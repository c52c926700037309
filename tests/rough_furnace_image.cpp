// Integrating spheres with walls that are not Lambert's: a ray meets a sphere at the angle at which it left, so the radiance depends on
// one angle alone, and an integral equation in one variable has it.
#include <functional>

#include "extremes.h"
#include "image.h"
#include "quadrature.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// Mean of pi f over the difference of the azimuths, at two cosines.
using Kernel = std::function<double(double, double)>;

// F90 - 1 is a + b cos(azimuth), so that its mean square is a^2 + b^2 / 2.
Kernel disney(double base, double r) {
  return [=](double m, double n) {
    const double a = r * (1 + m * n) - 0.5, b2 = r * r * (1 - m * m) * (1 - n * n);
    const double p = std::pow(1 - m, 5), q = std::pow(1 - n, 5);
    return base * (1 + a * (p + q) + (a * a + b2 / 2) * p * q);
  };
}

// The positive part of a cosine is 1/pi in the mean, its modulus 2/pi.
Kernel oren_nayar_fast(double rho, double sigma) {
  return [=](double m, double n) {
    const double s2 = sigma * sigma, a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
    return rho * (a + b / glm::pi<double>() * std::sqrt((1 - m * m) * (1 - n * n)) / std::max(m, n));
  };
}

Kernel oren_nayar(double rho, double sigma) {
  return [=](double m, double n) {
    const double pi = glm::pi<double>(), s2 = sigma * sigma, rough = s2 / (s2 + 0.09);
    const double alpha = std::acos(std::min(m, n)), beta = std::acos(std::max(m, n));
    const double lost = std::pow(2 * beta / pi, 3), c3 = 0.125 * rough * std::pow(4 * alpha * beta / (pi * pi), 2);
    const double single = 1 - 0.5 * s2 / (s2 + 0.33) + 0.45 * rough * lost / pi * std::tan(beta) + (1 - 2 / pi) * c3 * std::tan((alpha + beta) / 2);
    return rho * single + rho * rho * 0.17 * s2 / (s2 + 0.13);
  };
}

// L(m) = 1 + integral of K(m, n) L(n) 2 n dn, by Nystroem's method with 200 nodes, solved by iteration.
class Sphere {
 public:
  explicit Sphere(const Kernel& kernel) : kernel_(kernel), nodes_(gauss_legendre(200, 0, 1)), radiance_(nodes_.size(), 1) {
    std::vector<double> matrix;
    for (const Node& to : nodes_)
      for (const Node& from : nodes_) matrix.push_back(kernel(to.x, from.x) * 2 * from.x * from.weight);
    for (double change = 1; change > 1e-12;) {
      std::vector<double> next(nodes_.size(), 1);
      for (std::size_t i = 0; i < next.size(); ++i)
        for (std::size_t k = 0; k < next.size(); ++k) next[i] += matrix[i * next.size() + k] * radiance_[k];
      change = 0;
      for (std::size_t i = 0; i < next.size(); ++i) change = std::max(change, std::abs(next[i] - radiance_[i]));
      radiance_ = next;
    }
  }

  double radiance(double m) const {
    double sum = 1;
    for (std::size_t k = 0; k < nodes_.size(); ++k) sum += kernel_(m, nodes_[k].x) * 2 * nodes_[k].x * nodes_[k].weight * radiance_[k];
    return sum;
  }

 private:
  Kernel kernel_;
  std::vector<Node> nodes_;
  std::vector<double> radiance_;
};

Material rough(MaterialKind kind, double albedo, double roughness) {
  Material m = diffuse(albedo);
  m.kind = kind;
  m.roughness = static_cast<float>(roughness);
  return m;
}

// A sphere that emits 1 from its inside, seen from a distance `off` of its radius from its centre, across that radius: the wall is met
// at the cosine sqrt(1 - off^2).
World sphere(const Material& material, double off) {
  World world;
  WorldShape& wall = add_sphere(world, material, Sides::front, {0, 0, 0}, 1.0, 1.0);
  wall.flip_normals = true;
  const double cosine = std::sqrt(1 - off * off);
  look_closely(world, {off, 0, 0}, {off, cosine, 0});
  return world;
}

double expect_radiance(const Material& material, const Kernel& kernel, double off, double finds) {
  return expect_mean(render_full(sphere(material, off), 1024), Sphere(kernel).radiance(std::sqrt(1 - off * off)), finds);
}

}  // namespace

// Computed with 200 nodes elsewhere: base or reflectance, roughness, cosine, radiance.
TEST(rough_furnace_image, oracle_meets_known_values) {
  const Sphere smooth(disney(0.5, 0)), half(disney(0.5, 0.5)), retro(disney(0.8, 1)), paint(oren_nayar_fast(0.8, 0.5));
  for (const auto& [m, a, b, c, d] : {std::array{1.0, 1.93519959, 2.01428989, 6.74512392, 2.99332}, {0.5, 1.92058709, 2.01666051, 6.85957691, 3.24810},
                                      {0.17365, 1.75502263, 2.03385773, 8.07896794, 3.37099}}) {
    EXPECT_NEAR(smooth.radiance(m), a, 1e-5);
    EXPECT_NEAR(half.radiance(m), b, 1e-5);
    EXPECT_NEAR(retro.radiance(m), c, 1e-4);
    EXPECT_NEAR(paint.radiance(m), d, 2e-4);  // the kink at equal angles
  }
}

TEST(rough_furnace_image, sphere_with_disney_walls_has_its_radiance_at_the_centre_and_beside_it) {
  double worst = 0.0;
  for (const double r : {0.0, 0.5, 1.0})
    for (const double off : {0.0, 0.9}) {
      SCOPED_TRACE(testing::Message() << r << " " << off);
      worst = std::max(worst, expect_radiance(rough(MATERIAL_DISNEY, 0.5, r), disney(0.5, r), off, 0.01));
    }
  record_extreme("X40", worst, z_limit);
}

TEST(rough_furnace_image, sphere_with_oren_nayar_walls_has_its_radiance) {
  for (const double off : {0.0, 0.9}) {
    SCOPED_TRACE(off);
    expect_radiance(rough(MATERIAL_OREN_NAYAR_FAST, 0.8, 0.5), oren_nayar_fast(0.8, 0.5), off, 0.015);
    expect_radiance(rough(MATERIAL_OREN_NAYAR, 0.8, 0.5), oren_nayar(0.8, 0.5), off, 0.015);
  }
}
