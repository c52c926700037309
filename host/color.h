// Linear sRGB colours and the packed triples of the device, on the host.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "../cl/types.h"

namespace oclair {

inline packed_float3 pack(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

inline glm::dvec3 unpack(const packed_float3& v) { return {v.x, v.y, v.z}; }

inline double luminance(const glm::dvec3& rgb) { return glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722)); }  // Rec. ITU-R BT.709

inline double largest(const glm::dvec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

// Transfer curve of sRGB (IEC 61966-2-1), for encoded values in [0, 1]; its inverse is srgb_encoded (image.h).
inline double srgb_decoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace oclair
