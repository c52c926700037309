// Speed, bias and variance of one set of choices against another, from replicas that used the same random numbers: docs/tune.md derives
// each. Relative squares are those of stopping.h: mean over the pixels of |x|^2 w, w = 1/(|mu|^2 + 0.01 |m|^2), with mu the mean of the
// reference's replicas and m its mean colour. The reference has random numbers of its own: with weights from the accurate replicas
// themselves, a bright sample would count less in their variance than in that of others.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "replicas.h"
#include "statistics.h"

namespace oclair::tune {

struct Estimates {
  bool same = false;        // all replicas agree to the last bit
  Interval speed{};         // accurate seconds over its seconds, in the median of the replicas
  Interval bias{};          // mean of the difference, over the mean of the reference
  double bias_bound = 0.0;  // |bias| is below this: two one-sided tests (Schuirmann 1987)
  Interval squared_bias{};  // relative, of each pixel: without bias, so it may be negative
  Interval variance{};      // relative variance over the accurate one's
  double replica_variance = 0.0;   // relative, of the mean of one replica
  double replica_seconds = 0.0;    // median
};

// With which each statement of an estimate must hold, so that all of `settings` estimates hold together: there are five, the four intervals
// and the bound (Bonferroni). At most 1 - 1e-12.
double confidence_of_each(double together, std::size_t settings);

// All three have as many replicas, at least 2, of as many pixels. Intervals hold with `confidence` each, those of the bias with the noise of
// the reference in them. The speed is of replicas that were rendered in turn.
Estimates estimate(const std::vector<Picture>& reference, const Replicas& accurate, const Replicas& other, double confidence);

// Seconds until the relative error is `error`: noise and bias together. Nothing if the bias alone is as large.
std::optional<double> seconds_to_error(double error, double squared_bias, double replica_variance, double replica_seconds);

struct CurvePoint {
  double samples;  // a pixel
  double seconds;
  double error;    // relative, measured against the reference
};

// reference: accurate replicas with random numbers that the others do not share. Points whose error is lost in its noise are left out.
std::vector<CurvePoint> convergence(const Replicas& reference, const Replicas& other);

// Slope of log(error) over log(seconds) by least squares; nothing with fewer than two points.
std::optional<double> slope(const std::vector<CurvePoint>& curve);

// Mean over the replicas.
Picture mean_picture(const std::vector<Picture>& pictures);

}  // namespace oclair::tune
