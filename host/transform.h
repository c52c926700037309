// The elementary transforms of the scene format, acting on column vectors, in double precision. Mitsuba's conventions,
// each measured against it (tests/transform_test.cpp).
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace oclair {

glm::dmat4 translation(glm::dvec3 offset);
glm::dmat4 scaling(glm::dvec3 factors);

// Counter-clockwise by that many degrees for a viewer whom the axis points at. A rotation only if the axis has unit length:
// like Mitsuba, no normalisation happens here.
glm::dmat4 rotation(glm::dvec3 axis, double degrees);

// The frame of a camera at `origin`: z towards target, y as close to `up` as possible, x = up x z. An `up` of zero stands
// for some direction across z. Nothing if target = origin or up is parallel to z.
std::optional<glm::dmat4> look_at(glm::dvec3 origin, glm::dvec3 target, glm::dvec3 up);

// A rotation whose third column is the unit vector z; the other two as Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited", listing 3.
glm::dmat3 frame_around(glm::dvec3 z);

// Where the normals of a surface go, as unit vectors: by the inverse transpose of an invertible matrix.
class NormalTransform {
 public:
  explicit NormalTransform(const glm::dmat4& matrix);
  glm::dvec3 operator()(glm::dvec3 normal) const;

 private:
  glm::dmat3 cofactors_;  // of the unit columns: neither tiny nor huge scales leave the range
  glm::dvec3 lengths_;    // of the columns
  bool mirrors_;
};

// Where points, directions and normals go. The normal comes back as a unit vector; `matrix` must be invertible.
glm::dvec3 transform_point(const glm::dmat4& matrix, glm::dvec3 point);
glm::dvec3 transform_vector(const glm::dmat4& matrix, glm::dvec3 vector);
glm::dvec3 transform_normal(const glm::dmat4& matrix, glm::dvec3 normal);

// False if the matrix flattens space: the volume of the images of the unit vectors over the product of their lengths is
// below 1e-12, or a length is 0.
bool is_invertible(const glm::dmat4& matrix);

}  // namespace oclair
