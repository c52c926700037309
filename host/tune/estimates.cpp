#include "estimates.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace oclair::tune {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Sums over the replicas of each value, less that of `origin`.
struct Sums {
  Picture origin;
  std::vector<double> sum, square;  // per value: of x, of x^2

  explicit Sums(const std::vector<Picture>& pictures) : Sums(pictures, Picture(pictures.front().size())) {}
  Sums(const std::vector<Picture>& pictures, Picture from) : origin(std::move(from)), sum(origin.size()), square(sum.size()) {
    for (const Picture& picture : pictures)
      for (std::size_t i = 0; i < sum.size(); ++i) {
        const double x = of(picture, i);
        sum[i] += x, square[i] += x * x;
      }
  }

  double of(const Picture& picture, std::size_t i) const { return double{picture[i]} - origin[i]; }
};

// For variances: from the first picture as the origin, so that pictures that are all the same have none, to the last bit.
Sums around_first(const std::vector<Picture>& pictures) { return {pictures, pictures.front()}; }

template <class Value>
double mean_of(const std::vector<Value>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<double> weights_of(const Picture& mean) {
  std::array<double, 3> colour{};
  const std::size_t pixels = mean.size() / 3;
  for (std::size_t i = 0; i < mean.size(); ++i) colour[i % 3] += mean[i] / static_cast<double>(pixels);
  const double floor = 0.01 * (colour[0] * colour[0] + colour[1] * colour[1] + colour[2] * colour[2]);
  std::vector<double> weights(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    double square = floor;
    for (int c = 0; c < 3; ++c) square += double{mean[3 * p + c]} * mean[3 * p + c];
    weights[p] = square > 0.0 ? 1.0 / square : 0.0;
  }
  return weights;
}

// Mean over the pixels of weight times value(i) summed over the channels.
template <class Value>
double weighted(const std::vector<double>& weights, Value value) {
  double sum = 0.0;
  for (std::size_t p = 0; p < weights.size(); ++p) sum += weights[p] * (value(3 * p) + value(3 * p + 1) + value(3 * p + 2));
  return sum / static_cast<double>(weights.size());
}

// Of n replicas with these sums, less one that may be left out (null: none is).
double variance_of(const std::vector<double>& weights, const Sums& sums, double n, const Picture* without) {
  const double m = without ? n - 1.0 : n;
  return weighted(weights, [&](std::size_t i) {
    const double x = without ? sums.of(*without, i) : 0.0, sum = sums.sum[i] - x;
    return (sums.square[i] - x * x - sum * sum / m) / (m - 1.0);
  });
}

// Mean over pairs of different replicas of the product of their differences: without bias for the square of the mean difference.
double squared_bias_of(const std::vector<double>& weights, const Sums& sums, double n, const Picture* without) {
  const double m = without ? n - 1.0 : n;
  return weighted(weights, [&](std::size_t i) {
    const double x = without ? sums.of(*without, i) : 0.0, sum = sums.sum[i] - x;
    return (sum * sum - (sums.square[i] - x * x)) / (m * (m - 1.0));
  });
}

// The reference weighs as well, and has noise: replica k of both is left out together.
Interval squared_bias(const std::vector<double>& weights, const std::vector<Picture>& reference, const std::vector<Picture>& apart,
                      double confidence) {
  const Sums sums(apart), mu(reference);
  const double n = static_cast<double>(apart.size());
  std::vector<double> without;
  for (std::size_t k = 0; k < apart.size(); ++k) {
    Picture mean(mu.sum.size());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = static_cast<float>((mu.sum[i] - reference[k][i]) / (n - 1.0));
    without.push_back(squared_bias_of(weights_of(mean), sums, n, &apart[k]));
  }
  return jackknife_interval(squared_bias_of(weights, sums, n, nullptr), without, confidence);
}

// Relative to the mean of the reference, one number for each replica. That mean has noise, which makes the ratio b of two means err by
// -b times it, to first order (Casella, Berger 2002, 5.5.4): it is added to the differences.
std::vector<double> relative_shifts(const std::vector<Picture>& reference, const std::vector<Picture>& apart) {
  std::vector<double> shifts, levels;
  for (const Picture& d : apart) shifts.push_back(mean_of(d));
  for (const Picture& picture : reference) levels.push_back(mean_of(picture));
  const double level = mean_of(levels), ratio = level > 0.0 ? mean_of(shifts) / level : 0.0;
  for (std::size_t k = 0; k < shifts.size(); ++k) shifts[k] = level > 0.0 ? (shifts[k] - ratio * (levels[k] - level)) / level : 0.0;
  return shifts;
}

// The ratio of variances, whose logarithm is nearer to normal. Replica k of both is left out together.
Interval variance_ratio(const std::vector<double>& weights, const Replicas& accurate, const Replicas& other, double confidence) {
  const Sums a = around_first(accurate.pictures), b = around_first(other.pictures);
  const double n = static_cast<double>(accurate.pictures.size());
  const auto log_ratio = [&](const Picture* without_a, const Picture* without_b) {
    return std::log(variance_of(weights, b, n, without_b) / variance_of(weights, a, n, without_a));
  };
  const double va = variance_of(weights, a, n, nullptr), vb = variance_of(weights, b, n, nullptr);
  if (!(va > 0.0)) return vb > 0.0 ? Interval{infinity, 0.0, infinity} : Interval{1.0, 1.0, 1.0};
  if (!(vb > 0.0)) return {0.0, 0.0, 0.0};
  std::vector<double> without;
  for (std::size_t k = 0; k < accurate.pictures.size(); ++k) without.push_back(log_ratio(&accurate.pictures[k], &other.pictures[k]));
  const Interval logs = jackknife_interval(log_ratio(nullptr, nullptr), without, confidence);
  if (!std::isfinite(logs.low) || !std::isfinite(logs.high)) return {vb / va, 0.0, infinity};
  return {std::exp(logs.estimate), std::exp(logs.low), std::exp(logs.high)};
}

std::vector<Picture> differences(const std::vector<Picture>& a, const std::vector<Picture>& b) {
  std::vector<Picture> all;
  for (std::size_t k = 0; k < a.size(); ++k) {
    Picture& d = all.emplace_back(a[k].size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = b[k][i] - a[k][i];
  }
  return all;
}

}  // namespace

Picture mean_picture(const std::vector<Picture>& pictures) {
  const Sums sums(pictures);
  Picture mean(sums.sum.size());
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = static_cast<float>(sums.sum[i] / static_cast<double>(pictures.size()));
  return mean;
}

double confidence_of_each(double together, std::size_t settings) {
  return 1.0 - std::max(1e-12, (1.0 - together) / (5.0 * static_cast<double>(settings)));
}

Estimates estimate(const std::vector<Picture>& reference, const Replicas& accurate, const Replicas& other, double confidence) {
  assert(accurate.pictures.size() == other.pictures.size() && reference.size() == other.pictures.size() && reference.size() >= 2);
  const double n = static_cast<double>(accurate.pictures.size());
  const std::vector<double> weights = weights_of(mean_picture(reference));
  Estimates e;
  e.same = accurate.pictures == other.pictures;

  std::vector<double> speeds;
  for (std::size_t k = 0; k < accurate.seconds.size(); ++k) speeds.push_back(accurate.seconds[k] / other.seconds[k]);
  e.speed = median_interval(speeds, confidence);
  e.speed.low = std::max(e.speed.low, 0.0);
  e.replica_seconds = median_interval(other.seconds, confidence).estimate;

  const std::vector<Picture> apart = differences(accurate.pictures, other.pictures);
  const std::vector<double> shifts = relative_shifts(reference, apart);
  e.bias = mean_interval(shifts, confidence);
  const Interval one_sided = mean_interval(shifts, 2.0 * confidence - 1.0);
  e.bias_bound = std::max(std::abs(one_sided.low), std::abs(one_sided.high));
  e.squared_bias = squared_bias(weights, reference, apart, confidence);

  e.variance = variance_ratio(weights, accurate, other, confidence);
  e.replica_variance = std::max(0.0, variance_of(weights, around_first(other.pictures), n, nullptr));
  return e;
}

std::optional<double> seconds_to_error(double error, double squared_bias, double replica_variance, double replica_seconds) {
  const double left = error * error - std::max(0.0, squared_bias);
  if (!(left > 0.0)) return {};
  return replica_variance / left * replica_seconds;
}

std::vector<CurvePoint> convergence(const Replicas& reference, const Replicas& other) {
  const Picture mean = mean_picture(reference.pictures);
  const std::vector<double> weights = weights_of(mean);
  const double n = static_cast<double>(reference.pictures.size());
  const double noise = variance_of(weights, around_first(reference.pictures), n, nullptr) / n;
  const double seconds = median_interval(other.seconds, 0.5).estimate;
  std::vector<CurvePoint> curve;
  // The mean over some pictures of equal numbers of samples.
  const auto add = [&](double samples, const std::vector<Picture>& pictures) {
    if (pictures.empty()) return;
    double square = -noise;
    for (const Picture& picture : pictures)
      square += weighted(weights, [&](std::size_t i) { return std::pow(double{picture[i]} - mean[i], 2.0); }) / static_cast<double>(pictures.size());
    if (square > 0.0) curve.push_back({samples, seconds * samples / REPLICA_SAMPLES, std::sqrt(square)});
  };
  for (int level = 0; level < level_count - 1; ++level) add(1 << level, other.levels[level]);
  for (std::size_t count = 1; 4 * count <= other.pictures.size(); count *= 2) {
    std::vector<Picture> means;
    for (std::size_t first = 0; first + count <= other.pictures.size(); first += count) {
      const auto begin = other.pictures.begin() + static_cast<std::ptrdiff_t>(first);
      means.push_back(mean_picture({begin, begin + static_cast<std::ptrdiff_t>(count)}));
    }
    add(static_cast<double>(count) * REPLICA_SAMPLES, means);
  }
  return curve;
}

std::optional<double> slope(const std::vector<CurvePoint>& curve) {
  if (curve.size() < 2) return {};
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const double n = static_cast<double>(curve.size());
  for (const CurvePoint& point : curve) {
    const double log_x = std::log(point.seconds), log_y = std::log(point.error);
    x += log_x / n, y += log_y / n, xx += log_x * log_x / n, xy += log_x * log_y / n;
  }
  return xx > x * x ? std::optional((xy - x * y) / (xx - x * x)) : std::nullopt;
}

}  // namespace oclair::tune
