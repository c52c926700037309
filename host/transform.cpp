#include "transform.h"

#include <algorithm>
#include <cmath>

namespace oclair {

glm::dmat4 translation(glm::dvec3 offset) {
  glm::dmat4 result(1.0);
  result[3] = glm::dvec4(offset, 1.0);
  return result;
}

glm::dmat4 scaling(glm::dvec3 factors) {
  glm::dmat4 result(1.0);
  for (int i = 0; i < 3; ++i) result[i][i] = factors[i];
  return result;
}

glm::dmat4 rotation(glm::dvec3 axis, double degrees) {
  // Quarter turns are exact: sin(pi) is not 0 in floating point, and boxes turned by 90 degrees should stay boxes.
  double sine = std::sin(glm::radians(degrees)), cosine = std::cos(glm::radians(degrees));
  if (const double quarters = degrees / 90.0; quarters == std::round(quarters)) {
    const int quarter = static_cast<int>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
    sine = quarter == 1 ? 1.0 : quarter == 3 ? -1.0 : 0.0;
    cosine = quarter == 0 ? 1.0 : quarter == 2 ? -1.0 : 0.0;
  }
  // Rodrigues 1840: cos I + sin [axis]x + (1 - cos) axis axis^T.
  glm::dmat4 result(1.0);
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 unit(0.0);
    unit[column] = 1.0;
    result[column] = glm::dvec4(cosine * unit + sine * glm::cross(axis, unit) + (1.0 - cosine) * axis[column] * axis, 0.0);
  }
  return result;
}

glm::dmat3 frame_around(glm::dvec3 z) {
  const double sign = std::copysign(1.0, z.z);
  const double a = -1.0 / (sign + z.z);
  const double b = z.x * z.y * a;
  return {glm::dvec3(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), glm::dvec3(b, sign + z.y * z.y * a, -z.y), z};
}

std::optional<glm::dmat4> look_at(glm::dvec3 origin, glm::dvec3 target, glm::dvec3 up) {
  const double distance = glm::length(target - origin);
  if (!(distance > 0.0) || !std::isfinite(distance)) return std::nullopt;
  const glm::dvec3 z = (target - origin) / distance;
  if (up == glm::dvec3(0.0)) up = frame_around(z)[0];
  const double up_length = glm::length(up);
  if (!(up_length > 0.0) || !std::isfinite(up_length)) return std::nullopt;
  const glm::dvec3 side = glm::cross(up / up_length, z);
  const double length = glm::length(side);
  if (!(length > 1e-12)) return std::nullopt;
  const glm::dvec3 x = side / length;
  return glm::dmat4(glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0), glm::dvec4(z, 0.0), glm::dvec4(origin, 1.0));
}

glm::dvec3 transform_point(const glm::dmat4& matrix, glm::dvec3 point) {
  return glm::dvec3(matrix * glm::dvec4(point, 1.0));
}

glm::dvec3 transform_vector(const glm::dmat4& matrix, glm::dvec3 vector) { return glm::dmat3(matrix) * vector; }

NormalTransform::NormalTransform(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  lengths_ = {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
  const glm::dvec3 x = m[0] / lengths_.x, y = m[1] / lengths_.y, z = m[2] / lengths_.z;
  cofactors_ = {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
  mirrors_ = glm::dot(cofactors_[2], z) < 0.0;
}

glm::dvec3 NormalTransform::operator()(glm::dvec3 normal) const {
  const glm::dvec3 weights = normal / lengths_ * std::min({lengths_.x, lengths_.y, lengths_.z});
  const glm::dvec3 result = cofactors_[0] * weights.x + cofactors_[1] * weights.y + cofactors_[2] * weights.z;
  return glm::normalize(mirrors_ ? -result : result);
}

glm::dvec3 transform_normal(const glm::dmat4& matrix, glm::dvec3 normal) { return NormalTransform(matrix)(normal); }

bool is_invertible(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  const double lengths[] = {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
  for (const double length : lengths)
    if (!(length > 0.0) || !std::isfinite(length)) return false;
  return std::abs(glm::determinant(glm::dmat3(m[0] / lengths[0], m[1] / lengths[1], m[2] / lengths[2]))) > 1e-12;
}

}  // namespace oclair
