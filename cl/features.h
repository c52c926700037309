// What a scene can require. The host sets one bit for each thing that the scene has, and compiles the kernels with
// -DFEATURES=<bits>; kernels ask `if (HAS(DIELECTRIC) && ...)`, so that all code is always type-checked and the compiler
// removes what is off. The list stands once, here: name, bit, what `oclair info` says.
#ifndef OCLAIR_FEATURES_H
#define OCLAIR_FEATURES_H

#define FEATURE_LIST(X)                                                      \
  X(DIFFUSE, 0, "Lambert diffuse reflection")                                \
  X(MIRROR, 1, "perfect mirror")                                             \
  X(CONDUCTOR, 2, "smooth conductor, exact Fresnel")                         \
  X(DIELECTRIC, 3, "smooth dielectric, exact Fresnel")                       \
  X(TRIANGLES, 4, "triangle meshes")                                         \
  X(SMOOTH_NORMALS, 5, "interpolated vertex normals")                        \
  X(SPHERES, 6, "true spheres")                                              \
  X(DISKS, 7, "true disks")                                                  \
  X(CYLINDERS, 8, "true cylinders")                                          \
  X(TRIANGLE_LIGHTS, 9, "area lights made of triangles")                     \
  X(QUADRIC_LIGHTS, 10, "area lights on spheres, disks or cylinders")        \
  X(POINT_LIGHTS, 11, "point lights")                                        \
  X(DIRECTIONAL_LIGHTS, 12, "directional lights")                            \
  X(CONSTANT_LIGHT, 13, "constant light from around")                        \
  X(MOMENTS, 14, "second moments of every pixel")

enum Feature {
#define FEATURE_BIT(name, bit, description) FEATURE_##name = 1 << bit,
  FEATURE_LIST(FEATURE_BIT)
#undef FEATURE_BIT
};

#define FEATURE_TERM(name, bit, description) | FEATURE_##name
#define ALL_FEATURES (0 FEATURE_LIST(FEATURE_TERM))

#ifndef __cplusplus
#ifndef FEATURES
#define FEATURES ALL_FEATURES
#endif
#define HAS(name) ((FEATURES & FEATURE_##name) != 0)
#endif

#endif
