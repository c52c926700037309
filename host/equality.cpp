#include "equality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "../cl/types.h"

namespace oclair {
namespace {

constexpr std::uint64_t BLOCK = 8;  // pixels, side of the blocks of `pattern`

// Sum of numbers whose signs are random.
struct SignSum {
  double sum = 0.0, squares = 0.0;

  void add(double x) {
    sum += x;
    squares += x * x;
  }
  double deviate() const { return squares > 0.0 ? sum / std::sqrt(squares) : 0.0; }
  double tail() const { return sign_tail(std::abs(deviate())); }
};

// Sum of numbers whose means are 0.
struct BoundedSum {
  double sum = 0.0, variance = 0.0, bound = 0.0;

  void add(double x, double deviation, double largest) {
    sum += x;
    variance += deviation * deviation;
    bound = std::max(bound, largest);
  }
  double deviate() const { return variance > 0.0 ? sum / std::sqrt(variance) : 0.0; }
  double tail() const { return bounded_tail(std::abs(sum), variance, bound); }
};

// Of several sums of one kind.
template <class Sum>
void add_test(Equality& result, const std::string& name, const std::vector<Sum>& sums) {
  EqualityTest test{name, 1.0, 0.0};
  for (const Sum& sum : sums) {
    test.p = std::min(test.p, static_cast<double>(sums.size()) * sum.tail());
    if (std::abs(sum.deviate()) > std::abs(test.statistic)) test.statistic = sum.deviate();
  }
  result.tests.push_back(test);
}

// Differences of the two images. Nothing here but their signs depends on which image is which.
class Differences {
 public:
  Differences(const ImagePlanes& a, const ImagePlanes& b, const Replicas& replicas)
      : a_(a), b_(b), na_(static_cast<double>(replicas.a)), nb_(static_cast<double>(replicas.b)),
        unit_(std::max({a.error_unit, b.error_unit, double{std::numeric_limits<float>::denorm_min()}})) {}

  std::size_t channels() const { return a_.channels.size(); }
  std::size_t values() const { return a_.values.size(); }

  // 0 where it, or its error, is not finite.
  double plain(std::size_t i) const {
    const double d = double{a_.values[i]} - b_.values[i];
    return std::isfinite(d) && std::isfinite(double{a_.errors[i]} + b_.errors[i]) ? d : 0.0;
  }

  // Standard deviation of the difference over all ways to tell the replicas of the pixel apart, na and nb of them; the
  // difference itself is at most sqrt(na + nb - 1) times as large.
  double deviation(std::size_t i) const {
    const double d = plain(i), sa = error(a_, i), sb = error(b_, i), n = na_ + nb_;
    if (!std::isfinite(sa + sb)) return 0.0;
    const double squares =
        na_ * (na_ - 1.0) * sa * sa + nb_ * (nb_ - 1.0) * sb * sb + na_ * nb_ / n * d * d;  // around one mean
    return std::sqrt(squares * n / (na_ * nb_ * (n - 1.0)));
  }

  double studentised(std::size_t i) const {
    const double d = plain(i);
    return d != 0.0 ? d / deviation(i) : 0.0;
  }

  double largest_studentised() const { return std::sqrt(na_ + nb_ - 1.0); }

  // With n replicas in each: in units of an upper bound of its error among all ways to pair those of A with those of B.
  double paired(std::size_t i) const { return std::sqrt(na_ / (2.0 * na_ - 1.0)) * std::abs(studentised(i)); }

  // All replicas of one image are above all of the other: none of n is farther from their mean than n - 1 standard errors of
  // it. Rounding: of the values to float, of a standard error to 2^-31/sqrt(n) of the mean beside its unit.
  bool separated(std::size_t i) const {
    const double d = plain(i), size = std::abs(double{a_.values[i]}) + std::abs(double{b_.values[i]});
    const double rounding = size * (0x1p-24 + 0x1p-31 * std::sqrt(std::max(na_, nb_)));
    const double reach = ((na_ - 1.0) * error(a_, i) + (nb_ - 1.0) * error(b_, i)) * (1.0 + 0x1p-22);
    return std::abs(d) > reach + rounding;
  }

 private:
  // No smaller than that of the samples' exact sums: what rounding may have taken is added, to both images the same, so that
  // exchanging them changes nothing.
  double error(const ImagePlanes& image, std::size_t i) const {
    return std::sqrt(double{image.errors[i]} * image.errors[i] + unit_ * unit_);
  }

  const ImagePlanes &a_, &b_;
  const double na_, nb_, unit_;
};

using Triple = std::array<double, 3>;

double dot(const Triple& x, const Triple& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

// Products of the sums over two halves of a set of pixels: any pattern of differences that the halves share makes them
// positive.
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
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      any = any || differences.separated(i);
      if (replicas.alike) largest = std::max(largest, differences.paired(i));
    }
    apart += any;
  }
  const double pixels = static_cast<double>(image.pixels()), count = static_cast<double>(channels);
  const double chance = std::min(1.0, count * separation_probability(replicas.a, replicas.b));
  const double p_apart = binomial_tail(apart, pixels, chance),
               p_largest = std::min(1.0, pixels * count * sign_tail(largest));
  result.tests.push_back({"pixel", std::min(1.0, 2.0 * std::min(p_apart, p_largest)), apart});
}

template <class Sum, class Add>
std::vector<Sum> channel_sums(const Differences& differences, const Add& add) {
  std::vector<Sum> sums(differences.channels());
  for (std::size_t i = 0; i < differences.values(); ++i) add(sums[i % sums.size()], i);
  return sums;
}

void add_sign_tests(Equality& result, const Differences& differences, const ImagePlanes& image) {
  const auto studentised = [&](std::size_t i) { return differences.studentised(i); };
  add_test(result, "mean",
           channel_sums<SignSum>(differences, [&](SignSum& sum, std::size_t i) { sum.add(differences.plain(i)); }));
  add_test(result, "weighted",
           channel_sums<SignSum>(differences, [&](SignSum& sum, std::size_t i) { sum.add(studentised(i)); }));
  add_test(result, "pattern", pattern_sums(image, differences.channels(), studentised));
}

void add_draw_tests(Equality& result, const Differences& differences) {
  const double largest = differences.largest_studentised();
  add_test(result, "mean", channel_sums<BoundedSum>(differences, [&](BoundedSum& sum, std::size_t i) {
             const double deviation = differences.deviation(i);
             sum.add(differences.plain(i), deviation, largest * deviation);
           }));
  add_test(result, "weighted", channel_sums<BoundedSum>(differences, [&](BoundedSum& sum, std::size_t i) {
             if (differences.deviation(i) > 0.0) sum.add(differences.studentised(i), 1.0, largest);
           }));
}

void add_approximate_tests(Equality& result, const Differences& differences, const ImagePlanes& image) {
  const auto plain = [&](std::size_t i) { return differences.plain(i); };
  add_test(result, "mean", channel_sums<SignSum>(differences, [&](SignSum& sum, std::size_t i) { sum.add(plain(i)); }));
  add_test(result, "pattern", pattern_sums(image, differences.channels(), plain));
}

bool overlap(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b) {
  return std::any_of(a.begin(), a.end(), [&](const SampleRange& x) {
    return std::any_of(b.begin(), b.end(), [&](const SampleRange& y) { return x.first < y.end() && y.first < x.end(); });
  });
}

// Samples that ranges have beyond their complete replicas, those of each range, in ascending order.
std::vector<std::uint64_t> remainders(const std::vector<SampleRange>& ranges) {
  std::vector<std::uint64_t> counts;
  for (const SampleRange& range : ranges)
    if (range.count % REPLICA_SAMPLES != 0) counts.push_back(range.count % REPLICA_SAMPLES);
  std::sort(counts.begin(), counts.end());
  return counts;
}

}  // namespace

// The numbers of a sample are a function of seed, pixel and sample, whatever the scene (cl/rng.h).
Replicas replicas_of(const ImagePlanes& a, const ImagePlanes& b) {
  Replicas replicas;
  if (a.ranges.empty() || b.ranges.empty()) {
    replicas.why_not = "a header does not say which samples there are";
    return replicas;
  }
  replicas.a = count_replicas(a.ranges);
  replicas.b = count_replicas(b.ranges);
  const auto rest_a = remainders(a.ranges), rest_b = remainders(b.ranges);
  replicas.whole = rest_a.empty() && rest_b.empty() && !a.rejected && !b.rejected;
  if (replicas.a < 2 || replicas.b < 2)
    replicas.why_not = "an image has fewer than two replicas";
  else if (a.sampler != b.sampler)
    replicas.why_not = "the samplers are not the same";
  else if (a.seed == b.seed && overlap(a.ranges, b.ranges))
    replicas.why_not = "the images share random numbers";
  replicas.exchangeable = replicas.why_not.empty();
  replicas.alike = replicas.exchangeable && replicas.a == replicas.b && rest_a == rest_b;
  if (replicas.exchangeable && !replicas.alike) replicas.why_not = "the numbers of samples are not the same";
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
  const Differences differences(a, b, replicas);
  const std::string not_whole = a.rejected || b.rejected ? "samples were rejected" : "a replica is not complete";
  const auto leave_out = [&](const char* test, const std::string& why) {
    result.left_out.push_back(std::string(test) + ": " + why);
  };
  if (replicas.alike) {
    add_sign_tests(result, differences, a);
  } else if (replicas.exchangeable && replicas.whole) {
    add_draw_tests(result, differences);
    leave_out("pattern", replicas.why_not);
  } else {
    result.approximate = replicas.why_not + (replicas.exchangeable ? " and " + not_whole : "");
    add_approximate_tests(result, differences, a);
    leave_out("weighted", result.approximate);
  }
  if (replicas.exchangeable && replicas.whole)
    add_pixel_test(result, differences, a, replicas);
  else
    leave_out("pixel", replicas.exchangeable ? not_whole : replicas.why_not);
  if (a.stopped_by_error || b.stopped_by_error)
    result.approximate += (result.approximate.empty() ? "" : " and ") +
                          std::string("--error has chosen the number of samples by what they were");
  for (const EqualityTest& test : result.tests)
    result.p = std::min(result.p, static_cast<double>(result.tests.size()) * test.p);
  return result;
}

// 1 / (4 P(Z >= sqrt 2)) = 3.178 times the normal tail.
double sign_tail(double z) {
  const double factor = 1.0 / (2.0 * std::erfc(1.0));
  return std::min(1.0, factor * std::erfc(z / std::sqrt(2.0)));
}

double bounded_tail(double sum, double variance, double bound) {
  if (!(variance > 0.0)) return 1.0;
  return std::min(1.0, 2.0 * std::exp(-sum * sum / (2.0 * (variance + bound * sum / 3.0))));
}

// Chernoff 1952: exp(-n KL(k/n, q)) for k >= n q; and Markov's n q / k.
double binomial_tail(double k, double n, double q) {
  if (k <= 0.0 || k <= n * q) return 1.0;
  const double share = k / n;
  const double divergence =
      share * std::log(share / q) + (share < 1.0 ? (1.0 - share) * std::log((1.0 - share) / (1.0 - q)) : 0.0);
  return std::min({1.0, n * q / k, std::exp(-n * divergence)});
}

double separation_probability(std::uint64_t a, std::uint64_t b) {
  const double x = static_cast<double>(a), y = static_cast<double>(b);
  return std::min(1.0, 2.0 * std::exp(std::lgamma(x + 1.0) + std::lgamma(y + 1.0) - std::lgamma(x + y + 1.0)));
}

}  // namespace oclair
