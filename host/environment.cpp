#include "environment.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "color.h"
#include "distribution.h"
#include "texture.h"

namespace oclair {
namespace {

// Integrals over row y of cells, per cell, of the weights of its upper and of its lower texels in the linear interpolation:
// of (1 - s) and of s times the solid angle, where s runs from 0 to 1 down the cell.
struct RowWeights {
  double upper, lower;
};

RowWeights row_weights(uint columns, uint rows, uint y) {
  const double h = glm::pi<double>() / rows, a = y * h, b = (y + 1) * h;
  const double slope = (std::sin(b) - std::sin(a)) / h, around = 2.0 * glm::pi<double>() / columns;
  return {around * (std::cos(a) - slope), around * (slope - std::cos(b))};
}

}  // namespace

EnvironmentDistribution environment_distribution(const Image& image) {
  const Texels texels = texels_of(image, image.srgb);
  const uint columns = image.width, rows = std::max(image.height, 2u) - 1;
  EnvironmentDistribution result;
  result.cdf.resize(rows + std::size_t{rows} * columns);
  const auto read_row = [&](uint y) {
    std::vector<glm::dvec3> row(columns);
    for (uint x = 0; x < columns; ++x) {
      row[x] = texels.at(std::size_t{y} * columns + x);
      result.brightest = std::max({result.brightest, row[x].x, row[x].y, row[x].z});
    }
    return row;
  };
  std::vector<glm::dvec3> above = read_row(0);
  std::vector<double> row_power(rows), power(columns);
  for (uint y = 0; y < rows; ++y) {
    const std::vector<glm::dvec3> below = read_row(std::min(y + 1, image.height - 1));
    const RowWeights weights = row_weights(columns, rows, y);
    for (uint x = 0; x < columns; ++x) {
      const uint next = x + 1 == columns ? 0 : x + 1;
      const glm::dvec3 cell = 0.5 * (weights.upper * (above[x] + above[next]) + weights.lower * (below[x] + below[next]));
      result.integral += cell;
      power[x] = luminance(cell);
      row_power[y] += power[x];
    }
    if (row_power[y] == 0.0) std::fill(power.begin(), power.end(), 1.0);  // chosen once in 2^32 times, wherever
    std::ranges::copy(distribution(power), result.cdf.begin() + rows + std::ptrdiff_t{y} * columns);
    above = below;
  }
  std::ranges::copy(distribution(row_power), result.cdf.begin());
  return result;
}

}  // namespace oclair
