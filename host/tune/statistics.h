// Intervals for what tune measures.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace oclair::tune {

struct Interval {
  double estimate, low, high;

  bool contains(double value) const { return low <= value && value <= high; }
};

// Quantile of Student's t distribution with n >= 1 degrees of freedom, p in (0, 1).
double student_quantile(double p, unsigned degrees);

// Of the mean of independent values, at least 2: Student's t.
Interval mean_interval(std::span<const double> values, double confidence);

// Of the median of independent values with one continuous distribution, whatever it is: order statistics, between which the median
// lies with the probability of a binomial count (David, Nagaraja 2003, Order Statistics, 7.1). With too few values for the
// confidence it has no ends.
Interval median_interval(std::vector<double> values, double confidence);

// How many values that takes.
std::size_t values_for_median(double confidence);

// Of a function of n independent replicas, from its value with all of them and with each left out (the jackknife: Efron 1982, chapter 3).
Interval jackknife_interval(double all, std::span<const double> without, double confidence);

}  // namespace oclair::tune
