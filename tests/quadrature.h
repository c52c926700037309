#pragma once

#include <cmath>
#include <vector>

namespace oclair::test {

struct Node {
  double x, weight;
};

// Gauss-Legendre rule of n points on [low, high]: exact for polynomials of degree 2n - 1. The nodes are roots of the Legendre
// polynomial P_n, by Newton's method from Chebyshev's approximation (Davis and Rabinowitz 1984, sec. 2.7).
inline std::vector<Node> gauss_legendre(int n, double low, double high) {
  std::vector<Node> nodes;
  for (int i = 1; i <= n; ++i) {
    double x = std::cos(3.14159265358979323846 * (i - 0.25) / (n + 0.5)), slope = 0;
    for (int step = 0; step < 50; ++step) {
      double previous = 1, value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      slope = n * (x * value - previous) / (x * x - 1);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    nodes.push_back({low + (high - low) * (1 - x) / 2, (high - low) / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

}  // namespace oclair::test
