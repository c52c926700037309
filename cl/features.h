// What a scene can require, and which approximations a user can ask for.
#ifndef OCLAIR_FEATURES_H
#define OCLAIR_FEATURES_H

#include "types.h"

// The host sets one bit for each thing that the scene has, and compiles the kernels with -DFEATURES=<bits>; kernels ask
// `if (HAS(DIELECTRIC) && ...)`, so that all code is always type-checked and the compiler removes what is off. A kernel with more
// features than the scene has gives the same image. The list stands once, here: name, bit, the smallest shared kernel that has it
// (host/variant.h), what `oclair info` says.
#define FEATURE_LIST(X)                                                                                       \
  X(DIFFUSE, 0, PLAIN, "Lambert diffuse reflection")                                                          \
  X(OREN_NAYAR, 1, SURFACES, "Oren-Nayar diffuse reflection, the full model")                                 \
  X(OREN_NAYAR_FAST, 2, SURFACES, "Oren-Nayar diffuse reflection, the qualitative model")                     \
  X(DISNEY, 3, SURFACES, "Disney diffuse reflection")                                                         \
  X(MIRROR, 4, SURFACES, "perfect mirror")                                                                    \
  X(CONDUCTOR, 5, SURFACES, "smooth conductor")                                                               \
  X(DIELECTRIC, 6, SURFACES, "smooth dielectric")                                                             \
  X(THIN_DIELECTRIC, 7, SURFACES, "thin dielectric sheet")                                                    \
  X(BLEND, 8, FULL, "blends of two materials")                                                                \
  X(OPACITY, 9, FULL, "surfaces that let light straight through")                                             \
  X(BITMAPS, 10, TEXTURED, "textures from images")                                                            \
  X(CHECKERBOARDS, 11, TEXTURED, "checkerboard textures")                                                     \
  X(ATTRIBUTES, 12, TEXTURED, "textures from attributes of vertices or faces")                                \
  X(NORMAL_MAPS, 13, TEXTURED, "normal maps")                                                                 \
  X(BUMP_MAPS, 14, TEXTURED, "bump maps")                                                                     \
  X(TRIANGLES, 15, PLAIN, "triangle meshes")                                                                  \
  X(SMOOTH_NORMALS, 16, PLAIN, "interpolated vertex normals")                                                 \
  X(SPHERES, 17, SURFACES, "true spheres")                                                                    \
  X(DISKS, 18, SURFACES, "true disks")                                                                        \
  X(CYLINDERS, 19, SURFACES, "true cylinders")                                                                \
  X(TRIANGLE_LIGHTS, 20, PLAIN, "area lights made of triangles")                                              \
  X(QUADRIC_LIGHTS, 21, SURFACES, "area lights on spheres, disks or cylinders")                               \
  X(TEXTURED_LIGHTS, 22, TEXTURED, "area lights with a texture")                                              \
  X(POINT_LIGHTS, 23, SURFACES, "point lights")                                                               \
  X(SPOT_LIGHTS, 24, SURFACES, "spot lights")                                                                 \
  X(DIRECTIONAL_LIGHTS, 25, SURFACES, "directional lights")                                                   \
  X(CONSTANT_LIGHT, 26, SURFACES, "constant light from around")                                               \
  X(ENVIRONMENT_MAP, 27, TEXTURED, "an image of the light from around")                                       \
  X(THIN_LENS, 28, SURFACES, "camera with a lens")                                                            \
  X(ORTHOGRAPHIC, 29, SURFACES, "orthographic camera")                                                        \
  X(MOMENTS, 30, ALONE, "second moments of every pixel")                                                      \
  X(HIDDEN_EMITTERS, 31, FULL, "lights that the camera does not see")                                         \
  X(SOBOL, 32, ALONE, "Owen-scrambled Sobol sampling")

// What a user may ask for in place of the accurate default (-DAPPROXIMATIONS=<bits>): name, bit, how the image's header calls it.
// Without light sampling it is as accurate, only noisier.
#define APPROXIMATION_LIST(X)      \
  X(SCHLICK, 0, "fresnel=schlick") \
  X(CLAMP, 1, "clamp")             \
  X(BSDF_SAMPLING, 2, "light-sampling=bsdf")

#define FEATURE_MASK(name, bit, variant, description) | (1ul << (bit))
#define APPROXIMATION_MASK(name, bit, description) | (1ul << (bit))
#define ALL_FEATURES (0ul FEATURE_LIST(FEATURE_MASK))
#define ALL_APPROXIMATIONS (0ul APPROXIMATION_LIST(APPROXIMATION_MASK))

#ifdef __cplusplus
namespace oclair {
using Features = ulong;        // FEATURE_ bits
using Approximations = ulong;  // APPROXIMATION_ bits
#define DECLARE_FEATURE(name, bit, variant, description) inline constexpr Features FEATURE_##name = Features{1} << (bit);
FEATURE_LIST(DECLARE_FEATURE)
#undef DECLARE_FEATURE
#define DECLARE_APPROXIMATION(name, bit, description) \
  inline constexpr Approximations APPROXIMATION_##name = Approximations{1} << (bit);
APPROXIMATION_LIST(DECLARE_APPROXIMATION)
#undef DECLARE_APPROXIMATION
}  // namespace oclair
#else
enum {
#define FEATURE_NUMBER(name, bit, variant, description) FEATURE_BIT_##name = bit,
  FEATURE_LIST(FEATURE_NUMBER)
#undef FEATURE_NUMBER
#define APPROXIMATION_NUMBER(name, bit, description) APPROXIMATION_BIT_##name = bit,
  APPROXIMATION_LIST(APPROXIMATION_NUMBER)
#undef APPROXIMATION_NUMBER
};
#ifndef FEATURES
#define FEATURES ALL_FEATURES
#endif
#ifndef APPROXIMATIONS
#define APPROXIMATIONS 0
#endif
#define HAS(name) (((ulong)(FEATURES) >> FEATURE_BIT_##name & 1ul) != 0ul)
#define APPROXIMATES(name) (((ulong)(APPROXIMATIONS) >> APPROXIMATION_BIT_##name & 1ul) != 0ul)

// Groups of features that are asked for together.
#define HAS_QUADRICS (HAS(SPHERES) || HAS(DISKS) || HAS(CYLINDERS))
#define HAS_TEXTURES (HAS(BITMAPS) || HAS(CHECKERBOARDS) || HAS(ATTRIBUTES))
#define HAS_TANGENTS (HAS(NORMAL_MAPS) || HAS(BUMP_MAPS))
#define HAS_DELTAS (HAS(MIRROR) || HAS(CONDUCTOR) || HAS(DIELECTRIC) || HAS(THIN_DIELECTRIC))
#define HAS_NON_DELTAS (HAS(DIFFUSE) || HAS(OREN_NAYAR) || HAS(OREN_NAYAR_FAST) || HAS(DISNEY))
#define HAS_AREA_LIGHTS (HAS(TRIANGLE_LIGHTS) || HAS(QUADRIC_LIGHTS))
#define HAS_ENVIRONMENT (HAS(CONSTANT_LIGHT) || HAS(ENVIRONMENT_MAP))
#define HAS_PASSAGES (HAS(OPACITY) || HAS(HIDDEN_EMITTERS))  // rays that go on behind what they have met
#define HAS_LIGHTS (HAS_AREA_LIGHTS || HAS(POINT_LIGHTS) || HAS(SPOT_LIGHTS) || HAS(DIRECTIONAL_LIGHTS) || HAS_ENVIRONMENT)
#endif

#endif
