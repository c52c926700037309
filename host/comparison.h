// How far two images are apart: docs/compare.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace oclair {

// Over the values (each channel of each pixel) that are finite in both images. x is judged by r.
struct Metrics {
  std::uint64_t values = 0, left_out = 0;  // left out: not finite in one of them
  double mean = 0.0;                       // of r
  double signed_mean = 0.0;                // mean x - r
  double mse = 0.0;                        // mean (x - r)^2
  double relative_mse = 0.0;               // mean (x - r)^2 / (r^2 + 0.01)
  double smape = 0.0;                      // mean |x - r| / (|x| + |r|), in [0, 1]
  double maximum = 0.0;                    // largest |x - r|
  std::uint64_t maximum_at = 0;            // its index among the values
};

// Both have as many values. Without a finite value everything is 0.
Metrics compare(std::span<const float> x, std::span<const float> r);

struct Quantiles {
  double median = 0.0, p99 = 0.0, maximum = 0.0;  // sorted values number ceil(p n)
};

Quantiles quantiles(std::vector<float> values);

// Quantiles of |z|, z = (a - b) / sqrt(sa^2 + sb^2), over the values that are finite and whose errors are not both 0.
Quantiles deviations(std::span<const float> a, std::span<const float> b, std::span<const float> sa,
                     std::span<const float> sb);

}  // namespace oclair
