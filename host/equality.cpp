#include "equality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "../cl/types.h"

namespace oclair {
namespace {

constexpr std::uint64_t BLOCK = 8;  // pixels, side of the blocks of `pattern`

// Sum of numbers whose signs are random, in units of its deviation.
struct SignSum {
  double sum = 0.0, squares = 0.0;

  void add(double x) {
    sum += x;
    squares += x * x;
  }
  double deviate() const { return squares > 0.0 ? sum / std::sqrt(squares) : 0.0; }
};

// Of several deviates, or other comparisons, of one kind.
void add_test(Equality& result, const std::string& name, const std::vector<SignSum>& sums) {
  double largest = 0.0;
  for (const SignSum& sum : sums)
    if (std::abs(sum.deviate()) > std::abs(largest)) largest = sum.deviate();
  result.tests.push_back({name, std::min(1.0, static_cast<double>(sums.size()) * sign_tail(std::abs(largest))), largest});
}

// Differences of the two images, or 0 where there is no finite one. What depends on a value's size is the same when the images are
// exchanged.
class Differences {
 public:
  Differences(const ImagePlanes& a, const ImagePlanes& b, const Replicas& replicas) : a_(a), b_(b), replicas_(replicas) {}

  std::size_t channels() const { return a_.channels.size(); }

  double plain(std::size_t i) const {
    const double d = double{a_.values[i]} - b_.values[i];
    return std::isfinite(d) && std::isfinite(variance(i)) ? d : 0.0;
  }

  // In units of its error, which the difference itself is a part of: at most sqrt(n).
  double studentised(std::size_t i) const {
    const double d = plain(i);
    return d != 0.0 ? d / std::sqrt(variance(i) + d * d / static_cast<double>(replicas_.a)) : 0.0;
  }

  // In units of an upper bound of its error among all ways to tell the replicas apart: see `pixel` in docs/compare.md.
  double exchanged(std::size_t i) const {
    const double d = plain(i), n = static_cast<double>(replicas_.a);
    return d != 0.0 ? std::abs(d) / std::sqrt(2.0 * (n - 1.0) / n * variance(i) + d * d / n) : 0.0;
  }

  // All replicas of one image are above all of the other: none of n is farther from their mean than n - 1 standard errors of it.
  // Rounding: of the values to float, of a standard error to 2^-31/sqrt(n) of the mean.
  bool separated(std::size_t i) const {
    const double d = plain(i), na = static_cast<double>(replicas_.a), nb = static_cast<double>(replicas_.b);
    const double size = std::abs(double{a_.values[i]}) + std::abs(double{b_.values[i]});
    const double rounding = size * (0x1p-24 + 0x1p-31 * std::sqrt(std::max(na, nb)));
    const double reach = ((na - 1.0) * a_.errors[i] + (nb - 1.0) * b_.errors[i]) * (1.0 + 0x1p-22);
    return std::abs(d) > reach + rounding;
  }

 private:
  double variance(std::size_t i) const {
    const double sa = a_.errors[i], sb = b_.errors[i];
    return sa * sa + sb * sb;
  }

  const ImagePlanes &a_, &b_;
  const Replicas& replicas_;
};

using Triple = std::array<double, 3>;

double dot(const Triple& x, const Triple& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

// Products of the sums over two halves of a set of pixels: any pattern of differences that the halves share makes them positive.
template <class Value>
std::vector<SignSum> pattern_sums(const ImagePlanes& image, std::size_t channels, const Value& value) {
  SignSum pairs, blocks;
  const auto add_pixel = [&](Triple& sum, std::size_t pixel) {
    for (std::size_t c = 0; c < channels; ++c) sum[c] += value(pixel * channels + c);
  };
  for (std::size_t pixel = 0; pixel + 1 < image.pixels(); pixel += 2) {
    Triple first{}, second{};
    add_pixel(first, pixel);
    add_pixel(second, pixel + 1);
    pairs.add(dot(first, second));
  }
  for (std::uint64_t top = 0; top < image.height; top += BLOCK)
    for (std::uint64_t left = 0; left < image.width; left += BLOCK) {
      std::array<Triple, 2> halves{};  // of a checkerboard, so that no gradient tells them apart
      for (std::uint64_t y = top; y < std::min(top + BLOCK, image.height); ++y)
        for (std::uint64_t x = left; x < std::min(left + BLOCK, image.width); ++x)
          add_pixel(halves[(x + y) % 2], static_cast<std::size_t>(y * image.width + x));
      blocks.add(dot(halves[0], halves[1]));
    }
  return {pairs, blocks};
}

void add_pixel_test(Equality& result, const Differences& differences, const ImagePlanes& image, const Replicas& replicas) {
  const std::size_t channels = differences.channels();
  double apart = 0.0, largest = 0.0;
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    bool any = false;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t i = pixel * channels + c;
      any = any || differences.separated(i);
      if (replicas.a == replicas.b) largest = std::max(largest, differences.exchanged(i));
    }
    apart += any;
  }
  const double pixels = static_cast<double>(image.pixels()), count = static_cast<double>(channels);
  const double chance = std::min(1.0, count * separation_probability(replicas.a, replicas.b));
  const double p_apart = binomial_tail(apart, pixels, chance), p_largest = std::min(1.0, pixels * count * sign_tail(largest));
  result.tests.push_back({"pixel", std::min(1.0, 2.0 * std::min(p_apart, p_largest)), apart});
}

bool overlap(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b) {
  return std::any_of(a.begin(), a.end(), [&](const SampleRange& x) {
    return std::any_of(b.begin(), b.end(), [&](const SampleRange& y) { return x.first < y.end() && y.first < x.end(); });
  });
}

}  // namespace

Replicas replicas_of(const ImagePlanes& a, const ImagePlanes& b) {
  Replicas replicas;
  if (a.ranges.empty() || b.ranges.empty()) {
    replicas.why_not = "a header does not say how many samples there are";
    return replicas;
  }
  replicas.a = count_replicas(a.ranges);
  replicas.b = count_replicas(b.ranges);
  replicas.complete =
      replicas.a * REPLICA_SAMPLES == count_samples(a.ranges) && replicas.b * REPLICA_SAMPLES == count_samples(b.ranges);
  if (replicas.a < 2 || replicas.b < 2)
    replicas.why_not = "an image has fewer than two replicas";
  else if (a.sampler != b.sampler)
    replicas.why_not = "the samplers are not the same";
  else if (a.seed == b.seed && a.scene_hash == b.scene_hash && overlap(a.ranges, b.ranges))
    replicas.why_not = "the images share random numbers";
  replicas.exchangeable = replicas.why_not.empty();
  return replicas;
}

Equality test_equality(const ImagePlanes& a, const ImagePlanes& b) {
  assert(a.values.size() == b.values.size() && a.channels == b.channels);
  Equality result;
  if (a.errors.empty() || b.errors.empty()) {
    result.impossible = "no standard errors of " + std::string(a.errors.empty() && b.errors.empty() ? "both images"
                                                               : a.errors.empty()                   ? "the first image"
                                                                                                    : "the second image");
    return result;
  }
  const Replicas replicas = replicas_of(a, b);
  const bool alike = replicas.exchangeable && replicas.a == replicas.b;
  const std::string unlike = replicas.exchangeable ? "the numbers of samples are not the same" : replicas.why_not;
  const Differences differences(a, b, replicas);
  const std::size_t channels = differences.channels();
  const auto sums = [&](const auto& value) {
    std::vector<SignSum> of_channels(channels);
    for (std::size_t i = 0; i < a.values.size(); ++i) of_channels[i % channels].add(value(i));
    return of_channels;
  };
  const auto plain = [&](std::size_t i) { return differences.plain(i); };
  const auto studentised = [&](std::size_t i) { return differences.studentised(i); };
  add_test(result, "mean", sums(plain));
  if (alike)
    add_test(result, "weighted", sums(studentised));
  else
    result.left_out.push_back("weighted: " + unlike);
  add_test(result, "pattern", alike ? pattern_sums(a, channels, studentised) : pattern_sums(a, channels, plain));
  if (replicas.exchangeable && replicas.complete)
    add_pixel_test(result, differences, a, replicas);
  else
    result.left_out.push_back("pixel: " + (replicas.exchangeable ? "a replica is not complete" : replicas.why_not));
  for (const EqualityTest& test : result.tests) result.p = std::min(result.p, static_cast<double>(result.tests.size()) * test.p);
  return result;
}

// 1 / (4 P(Z >= sqrt 2)) = 3.178 times the normal tail.
double sign_tail(double z) {
  const double factor = 1.0 / (2.0 * std::erfc(1.0));
  return std::min(1.0, factor * std::erfc(z / std::sqrt(2.0)));
}

// Chernoff 1952: exp(-n KL(k/n, q)) for k >= n q; and Markov's n q / k.
double binomial_tail(double k, double n, double q) {
  if (k <= 0.0 || k <= n * q) return 1.0;
  const double share = k / n;
  const double divergence = share * std::log(share / q) + (share < 1.0 ? (1.0 - share) * std::log((1.0 - share) / (1.0 - q)) : 0.0);
  return std::min({1.0, n * q / k, std::exp(-n * divergence)});
}

double separation_probability(std::uint64_t a, std::uint64_t b) {
  const double x = static_cast<double>(a), y = static_cast<double>(b);
  return std::min(1.0, 2.0 * std::exp(std::lgamma(x + 1.0) + std::lgamma(y + 1.0) - std::lgamma(x + y + 1.0)));
}

}  // namespace oclair
