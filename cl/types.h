// The contract between host and device: every struct that crosses the border, once, valid as C++20 and as OpenCL C 1.2.
// tests/layout_test asks the device for each size and offset. Lengths are in the canonical frame (host/frame.h): the
// scene's geometry lies in [-1, 1]^3. No float3 here: it takes 16 bytes in OpenCL C and 12 in C++.
#ifndef OCLAIR_TYPES_H
#define OCLAIR_TYPES_H

#ifdef __cplusplus
#include <cstdint>
namespace oclair {
using uint = std::uint32_t;
using ulong = std::uint64_t;
#define OCLAIR_CONSTANT inline constexpr
#else
#define OCLAIR_CONSTANT __constant
// PoCL contracts a*b-c into fma by default, which breaks the antisymmetry that watertight edges rest on (Woop et al. 2013).
// Every kernel source includes this file first; where a fused operation is wanted, fma() is written.
#pragma OPENCL FP_CONTRACT OFF
#endif

OCLAIR_CONSTANT uint NONE = 0xffffffffu;  // no shape, no material, no light, no primitive; as a macro it would break other headers

#define QUADRIC_BIT 0x80000000u  // set in the id of a primitive that is a quadric and not a triangle
#define LEAF_BIT 0x80000000u     // set in a child reference that is a leaf (see BvhNode)
#define LEAF_COUNT_SHIFT 27      // 4 bits above it: blocks in the leaf; 0 means a single quadric
#define LEAF_INDEX_MASK ((1u << LEAF_COUNT_SHIFT) - 1u)
#define WORK_GROUP_SIZE 64        // the only local size that is ever used: PoCL compiles a kernel once per local size
#define TILE_WIDTH 8              // a work-group of 64 is a square tile of the film

typedef struct packed_float3 {
  float x, y, z;
} packed_float3;

typedef struct packed_uint3 {
  uint x, y, z;
} packed_uint3;

// A ray. Direction of unit length for paths. Hits are looked for in 0 < t <= t_max (closest) or 0 < t < t_max (any).
typedef struct Ray {
  packed_float3 origin;
  float t_max;
  packed_float3 direction;
  uint skip;    // primitive that the ray starts on, or NONE: it cannot be hit again (a quadric: not at its near root)
  uint target;  // shadow rays: primitive of the light that the ray ends on, or NONE: it does not shadow itself
} Ray;

typedef struct Hit {
  float t;         // parameter along the ray, in units of its direction's length
  float b1, b2;    // triangle: barycentric coordinates of vertices 1 and 2
  uint primitive;  // triangle index, or QUADRIC_BIT | quadric index, or NONE for a miss
  uint slot;       // triangle: block * BVH_WIDTH + lane, where its vertices lie
} Hit;

// What a group of triangles or one quadric has in common: one object of the scene file.
typedef struct Shape {
  uint material_front;  // on the side that the geometric normal points to; NONE absorbs everything
  uint material_back;
  uint first_light;     // light of its first triangle, or of the quadric; NONE: does not emit
  uint first_triangle;  // lights of one mesh lie in the order of its triangles
  uint smooth;          // 1: the shading normal is interpolated from vertex normals
} Shape;

enum QuadricKind { QUADRIC_SPHERE, QUADRIC_DISK, QUADRIC_CYLINDER };

// Sphere |q| = 1, disk |q.xy| <= 1 at q.z = 0 (normal +z), open cylinder |q.xy| = 1 with 0 <= q.z <= 1 (normal outwards),
// where q = (axis_x . d, axis_y . d, axis_z . d) with d = p - center. The axes are orthogonal, their lengths the inverse scales.
typedef struct Quadric {
  packed_float3 center;
  uint kind;
  packed_float3 axis_x;
  uint shape;
  packed_float3 axis_y;
  float flip;  // 1, or -1 when the scene file turns the normal round
  packed_float3 axis_z;
  float area;
} Quadric;

enum MaterialKind { MATERIAL_DIFFUSE, MATERIAL_MIRROR, MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC };

typedef struct Material {
  packed_float3 reflectance;  // diffuse: albedo; mirror, conductor, dielectric: factor of the reflected light
  uint kind;
  packed_float3 transmittance;  // dielectric: factor of the transmitted light
  float eta;                    // dielectric: refractive index of the back side over that of the front side
  packed_float3 conductor_eta;  // conductor: real part of the refractive index, relative to the medium outside
  float pad0;
  packed_float3 conductor_k;  // conductor: its extinction coefficient
  float pad1;
} Material;

enum LightKind { LIGHT_TRIANGLE, LIGHT_QUADRIC, LIGHT_POINT, LIGHT_DIRECTIONAL, LIGHT_CONSTANT };

typedef struct Light {
  packed_float3 radiance;  // area, constant: W/(m^2 sr); point: W/sr in canonical lengths; directional: W/m^2
  uint kind;
  packed_float3 position;  // triangle: vertex 0; point: the point; directional: the direction in which the light travels
  float probability;       // that light_select chooses it
  packed_float3 edge1;     // triangle: vertex 1 - vertex 0
  uint primitive;          // triangle and quadric: its primitive id
  packed_float3 edge2;     // triangle: vertex 2 - vertex 0
  float area;              // triangle: area, canonical
} Light;

// Ray through film position (x, y), in pixels of the full film: direction corner + x step_x + y step_y before normalisation;
// its component along the viewing axis is 1 in canonical length.
typedef struct Camera {
  packed_float3 origin;
  float near_clip;
  packed_float3 corner;
  float far_clip;
  packed_float3 step_x;
  float pad0;
  packed_float3 step_y;
  float pad1;
} Camera;

// One for the whole render.
typedef struct Settings {
  ulong seed;
  uint film_width, film_height;    // full film, pixels: the numbering of random streams
  uint crop_x, crop_y;             // part that is rendered
  uint crop_width, crop_height;
  uint max_depth;                  // number of path segments at most; 1: directly visible emission only
  uint rr_depth;                   // Russian roulette from this depth on
  uint hide_emitters;
  uint light_count;
  uint sample_border;              // 1: the filter reaches beyond the film's edge
  uint filter_count;               // entries of the filter table (film position filter), >= 2
  float filter_radius;             // pixels
  int film_exponent;               // sums count units of 2^(film_exponent - FILM_FRACTION_BITS)
  packed_float3 environment;       // radiance of the constant light; 0 without one
  float environment_probability;   // that light_select chooses it
} Settings;

#define FILM_FRACTION_BITS 54         // bits of a film sum below 2^film_exponent
#define FILM_MOMENT_FRACTION_BITS 38  // half the bits of a film product below 2^film_exponent
#define FILM_HEADROOM_BITS 40         // a sample of 2^(film_exponent + this) or more is rejected and counted

// Exact sums: 128-bit two's complement integers, least significant limb first. Integer addition is associative, so the film
// depends only on the set of samples, not on their order. See docs/decisions/.
typedef struct FilmPixel {
  ulong sum[3][2];  // r, g, b
  ulong rejected;   // samples left out: not finite, negative or too large
  ulong hits;       // samples whose camera ray met something (alpha)
} FilmPixel;

typedef struct FilmMoments {
  ulong product[6][3];  // 192-bit sums of products of two channels, in units of 2^(2 (film_exponent - FILM_MOMENT_FRACTION_BITS))
} FilmMoments;

// Where the product of channels a and b stands: rr, gg, bb, rg, rb, gb.
#define MOMENT_INDEX(a, b) ((a) == (b) ? (a) : (a) + (b) + 2)

// Where a path stands between two stages.
typedef struct PathState {
  Ray ray;
  packed_float3 throughput;
  packed_float3 radiance;
  float eta;         // product of the relative indices crossed: undoes the radiance scaling in Russian roulette
  float pdf;         // solid-angle density of the sampled direction; 0 after a delta scattering or from the camera
  uint depth;        // segments finished
  uint hit_anything; // of the camera ray: alpha
  uint alive;
} PathState;

// A shadow ray and what it brings if nothing is in its way. No work: contribution 0.
typedef struct ShadowRay {
  Ray ray;
  packed_float3 contribution;
} ShadowRay;

// The node: W children, their boxes in rows lo.x hi.x lo.y hi.y lo.z hi.z. A child is a node index, or LEAF_BIT with block
// count and first block (or quadric index). Empty children have inverted boxes. In C++ the width is a template parameter,
// because it is chosen from the device; a kernel is compiled with one BVH_WIDTH.
#ifdef __cplusplus
#define OCLAIR_WIDE template <int BVH_WIDTH>
#else
#define OCLAIR_WIDE typedef
#ifndef BVH_WIDTH
#define BVH_WIDTH 8
#endif
#endif

OCLAIR_WIDE struct BvhNode {
  float bounds[6][BVH_WIDTH];
  uint child[BVH_WIDTH];
  uint pad[BVH_WIDTH];
}
#ifndef __cplusplus
BvhNode
#endif
;

// Vertices of W triangles as structure of arrays; unused lanes repeat the last triangle.
OCLAIR_WIDE struct TriangleBlock {
  float vertex[3][3][BVH_WIDTH];  // vertex, axis, lane
  uint primitive[BVH_WIDTH];
}
#ifndef __cplusplus
TriangleBlock
#endif
;

#ifdef __cplusplus
}  // namespace oclair
#endif
#endif
