// Whether two images can be renders of the same picture: a test of what their standard errors say. Between renders that are
// drawn alike and independently its false-alarm rate holds whatever the distribution of a pixel is. docs/compare.md derives
// it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image_planes.h"

namespace oclair {

// One of the tests that share the false-alarm rate.
struct EqualityTest {
  std::string name;  // mean, weighted, pattern, pixel
  double p;          // at least the probability of so much, or more, if the images are equal; at most 1
  double statistic;  // the largest of its deviates; of `pixel`: values whose replicas lie apart
};

struct Equality {
  std::string impossible;   // why there is no test; empty: there is one
  std::string approximate;  // why the rate rests on the means being normally distributed; empty: it rests on no distribution
  std::vector<EqualityTest> tests;
  std::vector<std::string> left_out;  // tests that were not made, and why
  double p = 1.0;                     // of all together: the smallest p times the number of tests

  bool differs(double alpha) const { return impossible.empty() && p < alpha; }
};

// What the headers of two images say of the replicas of a pixel.
struct Replicas {
  std::uint64_t a = 0, b = 0;  // complete ones
  bool whole = false;          // no samples beyond them, in either, and none was rejected
  bool exchangeable = false;   // drawn alike and independently: a replica might as well be in the other image
  bool alike = false;          // exchangeable, and as many in both: the images might be each other
  std::string why_not;         // not exchangeable, or not alike
};

Replicas replicas_of(const ImagePlanes& a, const ImagePlanes& b);

// The images have equal sizes and channels.
Equality test_equality(const ImagePlanes& a, const ImagePlanes& b);

// At least the probability that |sum of e_i x_i| >= z sqrt(sum x_i^2) for any numbers x_i and independent signs e_i = +-1:
// Bentkus and Dzindzalieta 2015, "A tight Gaussian bound for weighted sums of Rademacher random variables", Bernoulli 21(2).
double sign_tail(double z);

// At least the probability that a sum of independent numbers is `sum` or more away from 0, if their means are 0, their
// variances sum to `variance` and none is larger than `bound`: Bernstein's inequality; Boucheron, Lugosi, Massart 2013,
// "Concentration Inequalities", section 2.8.
double bounded_tail(double sum, double variance, double bound);

// At least the probability of k or more successes in n trials, of probability q each.
double binomial_tail(double k, double n, double q);

// 2 / binomial(a + b, a): of a + b numbers in random order, the first a all lie on one side of the others.
double separation_probability(std::uint64_t a, std::uint64_t b);

}  // namespace oclair
