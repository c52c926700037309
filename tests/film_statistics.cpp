// The standard error that the film promises is the spread that sequences of known variance have.
#include "../host/film.h"
#include "kernel.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr std::size_t pixels = 4000, replicas = 12;

// Means and promises of `pixels` pixels, of samples of mean 1/2 that draw(k) makes for the k-th of each replica. `deviation`
// is that of the mean of all samples.
template <class Draw>
void expect_promise(double deviation, const Draw& draw) {
  std::vector<packed_float3> samples;
  for (std::size_t i = 0; i < pixels * replicas * REPLICA_SAMPLES; ++i) {
    const float x = draw(i % REPLICA_SAMPLES), y = draw(i % REPLICA_SAMPLES), z = draw(i % REPLICA_SAMPLES);
    samples.push_back({x, y, z});
  }
  Film film{1, 1, 0, replicas * REPLICA_SAMPLES, FilmVector<FilmPixel>(pixels), {}, FilmVector<FilmErrors>(pixels), replicas};
  run_with({every_feature & ~FEATURE_MOMENTS}, "film_test.cl", "add_in_replicas", pixels, samples,
           static_cast<cl_uint>(replicas * REPLICA_SAMPLES), cl_ulong{0}, cl_int{0}, out(film.pixels), out(film.errors));
  double promised = 0.0, spread = 0.0, covered = 0.0;
  for (std::size_t i = 0; i < pixels; ++i)
    for (int c = 0; c < 3; ++c) {
      const double z = (pixel_mean(film, i)[c] - 0.5) / deviation, error = (*pixel_standard_error(film, i))[c] / deviation;
      promised += error * error;
      spread += z * z;
      covered += std::abs(z) <= 2.2010 * error;  // Student's t, 11 degrees of freedom, two-sided 95 %
    }
  // Three comparisons in each of two tests. Sums of 16 uniform numbers have an excess kurtosis of -1.2/16: the variances of
  // s^2, at most 2/(replicas - 1) of its square, and of z^2, at most 2, are a little smaller than a normal variable's. A sum
  // of m terms of skewness g has its quantile at z + g (z^2 - 1)/(6 sqrt(m)) (Cornish, Fisher 1938): with g = sqrt(8) for
  // z^2, sqrt(8/(replicas - 1)) for s^2, and 0.9/sqrt(0.95 0.05) for the count.
  const double n = 3.0 * pixels, z = z_bound(3);
  const auto quantile = [&](double skewness) { return z + skewness * (z * z - 1) / (6 * std::sqrt(n)); };
  EXPECT_NEAR(promised / n, 1.0, quantile(std::sqrt(8 / (replicas - 1.0))) * std::sqrt(2.0 / (replicas - 1.0) / n));
  EXPECT_NEAR(spread / n, 1.0, quantile(std::sqrt(8.0)) * std::sqrt(2.0 / n));
  EXPECT_NEAR(covered / n, 0.95, quantile(0.9 / std::sqrt(0.95 * 0.05)) * std::sqrt(0.95 * 0.05 / n));
}

}  // namespace

TEST(film_statistics, standard_error_of_independent_samples_is_their_deviation) {
  Random random(1);
  expect_promise(std::sqrt(1.0 / 12.0 / (replicas * REPLICA_SAMPLES)), [&](std::size_t) { return random.unit24(); });
}

// One sample in each R-th of the unit interval: the variance of each is 1/(12 R^2).
TEST(film_statistics, standard_error_of_stratified_replicas_is_theirs_and_not_that_of_independent_samples) {
  Random random(2);
  expect_promise(std::sqrt(1.0 / 12.0 / (replicas * std::pow(REPLICA_SAMPLES, 3.0))), [&](std::size_t k) {
    return (static_cast<float>(k) + random.unit24()) / REPLICA_SAMPLES;
  });
}
