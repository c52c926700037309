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

// What a group of triangles or one quadric has in common: one object of the scene file.
typedef struct Shape {
  uint material_front;  // on the side that the geometric normal points to; NONE absorbs everything
  uint material_back;
  uint first_light;     // light of its first triangle, or of the quadric; NONE: does not emit
  uint light_split;     // each of its triangles is light_split^2 lights, see light.h; 1 unless its radiance is textured
  uint first_triangle;  // lights of one mesh lie in the order of its triangles
  uint first_normal;    // normal of its vertex 0; NONE: flat
  uint first_uv;        // texture coordinates of its vertex 0; NONE: has none, or nothing asks for them
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

// The kinds before MATERIAL_MIRROR scatter into all directions, those from it on into single ones (deltas).
enum MaterialKind {
  MATERIAL_DIFFUSE,
  MATERIAL_OREN_NAYAR,       // the full model
  MATERIAL_OREN_NAYAR_FAST,  // the qualitative model
  MATERIAL_DISNEY,           // the diffuse part of Burley 2012
  MATERIAL_MIRROR,
  MATERIAL_CONDUCTOR,
  MATERIAL_DIELECTRIC,
  MATERIAL_THIN_DIELECTRIC,
  MATERIAL_BLEND             // one of two materials, chosen at random at each vertex of a path
};

// A texture, where there is one, is 1 + its index; 0: none. A material of zeros is plain, black and opaque.
typedef struct Material {
  packed_float3 reflectance;  // diffuse kinds: albedo or base colour; others: factor of the reflected light
  uint kind;
  packed_float3 transmittance;  // dielectrics: factor of the transmitted light
  float eta;                    // dielectrics: refractive index of the back side (thin: of the inside) over that of the front side
  packed_float3 conductor_eta;  // conductor: real part of the refractive index, relative to the medium outside
  float roughness;              // Oren-Nayar: sigma in radians; Disney: in [0, 1]; with a texture: factor of what that says
  packed_float3 conductor_k;    // conductor: its extinction coefficient
  float transparency;           // share of light that goes straight through, 1 - opacity
  uint reflectance_texture;     // these take the place of the constants above
  uint transmittance_texture;
  uint roughness_texture;
  uint opacity_texture;
  uint normal_texture;          // of normals in the tangent frame, (n + 1) / 2
  uint bump_texture;            // of heights
  float bump_scale;             // canonical length of height 1
  float weight;                 // blend: that the second one is chosen
  uint weight_texture;
  uint first, second;           // blend: the two materials
  uint normal_turned;           // 1: of the normal texture, x and y point the other way
} Material;

enum TextureKind { TEXTURE_BITMAP, TEXTURE_CHECKERBOARD, TEXTURE_VERTEX_ATTRIBUTE, TEXTURE_FACE_ATTRIBUTE };
enum TexelFormat { TEXEL_U8, TEXEL_U16, TEXEL_HALF, TEXEL_FLOAT };  // integers: shares of the largest one
enum TextureWrap { WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP };

// A colour (3 channels) or a number (1 channel) that varies over a surface.
typedef struct Texture {
  packed_float3 color0;  // checkerboard: where both halves of the unit square agree
  uint kind;
  packed_float3 color1;  // and where they differ
  uint channels;         // 1 or 3
  packed_float3 to_u;    // u of the lookup: dot(to_u, (u, v, 1))
  uint format;           // of its texels; attributes: TEXEL_FLOAT
  packed_float3 to_v;
  uint srgb;             // 1: integer texels are encoded as sRGB
  ulong offset;          // bytes from the start of the texels to its first, a multiple of 4; rows from top to bottom
  uint width, height;    // bitmap, texels
  uint wrap;
  uint nearest;          // 1: no interpolation
} Texture;

enum LightKind {
  LIGHT_TRIANGLE,
  LIGHT_QUADRIC,
  LIGHT_POINT,
  LIGHT_SPOT,
  LIGHT_DIRECTIONAL,
  LIGHT_CONSTANT,
  LIGHT_ENVIRONMENT  // a texture around the scene
};

typedef struct Light {
  packed_float3 radiance;  // area, constant, environment (its factor): W/(m^2 sr); point, spot: W/sr in canonical lengths; directional: W/m^2
  uint kind;
  packed_float3 position;  // triangle: vertex 0; point, spot: the point; directional: the direction in which the light travels
  float probability;       // that distribution_select chooses it
  packed_float3 edge1;     // triangle: vertex 1 - vertex 0; spot: unit direction of its axis
  uint primitive;          // triangle and quadric: its primitive id
  packed_float3 edge2;     // triangle: vertex 2 - vertex 0; spot: cutoff angle and beam width, radians
  float area;              // triangle: area, canonical
  uint texture;            // area: 1 + index of the texture that takes the place of the radiance, or 0
  uint part;               // triangle: which part of its triangle, below split^2, see light.h
  uint split;
  uint pad;
} Light;

// Ray through film position (x, y), in pixels of the full film. Perspective: direction corner + x step_x + y step_y before
// normalisation; its component along the viewing axis is 1 in canonical length. Orthographic: the ray starts at
// origin + corner + x step_x + y step_y and runs along the axis.
typedef struct Camera {
  packed_float3 origin;
  float near_clip;
  packed_float3 corner;
  float far_clip;
  packed_float3 step_x;
  float aperture_radius;  // thin lens: of the lens, canonical; 0: pinhole
  packed_float3 step_y;
  float focus_distance;   // thin lens: depth of the plane in focus, canonical
  packed_float3 axis;     // unit viewing direction
  uint orthographic;
} Camera;

// Entry i of the table of the reconstruction filter (filter.h), which runs over [-radius, radius].
typedef struct FilterEntry {
  float density;
  float integral;  // of the density, up to here
  uint first;      // where the search for the integral i / (count - 1) and above begins: an entry whose integral is not larger
} FilterEntry;

enum SamplerKind { SAMPLER_INDEPENDENT, SAMPLER_SOBOL };

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
  packed_float3 environment;       // radiance of the constant light, or factor of the environment map; 0 without one
  float environment_probability;   // that distribution_select chooses it
  packed_float3 environment_x;     // rows of the rotation from the world to the environment map
  uint environment_texture;        // 1 + its index, or 0
  packed_float3 environment_y;
  uint sampler;                    // SamplerKind
  packed_float3 environment_z;
  float largest_sample;            // with APPROXIMATION_CLAMP: largest channel of a sample, as the film has it; > 0
} Settings;

#define FILM_FRACTION_BITS 54         // bits of a film sum below 2^film_exponent
#define FILM_MOMENT_FRACTION_BITS 38  // half the bits of a film product below 2^film_exponent
#define FILM_SQUARE_FRACTION_BITS 36  // the same of a replica's square, see FilmErrors
#define FILM_HEADROOM_BITS 40         // a sample of 2^(film_exponent + this) or more is rejected and counted
#define REPLICA_BITS 4                // docs/decisions/sampler.md: why so many
#define REPLICA_SAMPLES (1 << REPLICA_BITS)

// Exact sums: unsigned 128-bit integers, least significant limb first. Integer addition is associative, so the film
// depends only on the set of samples, not on their order. See docs/decisions/.
typedef struct FilmPixel {
  ulong sum[3][2];  // r, g, b
  ulong rejected;   // samples left out: not finite, negative or too large
  ulong hits;       // samples whose camera ray met something (alpha)
} FilmPixel;

typedef struct FilmMoments {
  ulong product[6][3];  // 192-bit sums of products of two channels, in units of 2^(2 (film_exponent - FILM_MOMENT_FRACTION_BITS))
} FilmMoments;

// What the standard error of a pixel is made of. Replica k of a pixel is its samples [k REPLICA_SAMPLES, (k + 1) REPLICA_SAMPLES); these are
// sums over the replicas that are complete. Like the pixel's own, they add up when disjoint ranges of replicas are joined.
typedef struct FilmErrors {
  ulong sum[3][2];     // of their samples, in units of FilmPixel::sum
  ulong square[3][3];  // of the squares of each replica's sum, 192 bits, in units of 2^(2 (film_exponent - FILM_SQUARE_FRACTION_BITS))
} FilmErrors;

// Where the product of channels a and b stands: rr, gg, bb, rg, rb, gb.
#define MOMENT_INDEX(a, b) ((a) == (b) ? (a) : (a) + (b) + 2)

#define AOV_SAMPLES REPLICA_SAMPLES  // of each pixel, its first replica, are what AovPixel describes: it depends on nothing else

// What the first surfaces of a pixel's camera rays are: sums over those samples that met one. See aov.h.
typedef struct AovPixel {
  packed_float3 albedo;
  uint hits;               // samples that met a surface
  packed_float3 normal;    // shading normals, unit, on the side of the camera
  uint primitive;          // Hit::primitive of the ray through the pixel's centre
  float u, v;              // texture coordinates
  float depth;             // of the hit points from Camera::origin along its axis
  uint pixel;              // in the crop window, row by row, or NONE: a work item without a pixel
} AovPixel;

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

#ifndef __cplusplus
#include "precision.h"
#endif

// What a path is made of, in the precision of the arithmetic: float in every kernel that has it in a buffer.

// A ray. Direction of unit length for paths. Hits are looked for in 0 < t <= t_max (closest) or 0 < t < t_max (any). Hits are in order
// of (t, primitive); of a ray that has gone through some, only those after (t_min, passed) are left for the closest one.
typedef struct Ray {
  packed_float3 origin;
  float t_max;
  packed_float3 direction;
  uint skip;    // primitive that the ray starts on, or NONE: it cannot be hit again (a quadric: not at its near root)
  uint target;  // shadow rays: primitive of the light that the ray ends on, or NONE: it does not shadow itself
  float t_min;  // where it went through the last one; 0 at first
  uint passed;  // and which that was
} Ray;

typedef struct Hit {
  float t;         // parameter along the ray, in units of its direction's length
  float b1, b2;    // triangle: barycentric coordinates of vertices 1 and 2
  uint primitive;  // triangle index, or QUADRIC_BIT | quadric index, or NONE for a miss
  uint slot;       // triangle: block * BVH_WIDTH + lane, where its vertices lie
} Hit;

// Where a path stands between two stages.
typedef struct PathState {
  Ray ray;
  packed_float3 throughput;
  packed_float3 radiance;
  float eta;         // product of the relative indices crossed: undoes the radiance scaling in Russian roulette
  float pdf;         // solid-angle density of the sampled direction; 0 after a delta scattering or from the camera
  uint depth;        // segments finished
  uint passes;       // surfaces that let the path through
  uint hit_anything; // of the camera ray: alpha
  uint alive;
} PathState;

// A shadow ray and what it brings if nothing is in its way. No work: contribution 0.
typedef struct ShadowRay {
  Ray ray;
  packed_float3 contribution;
  uint depth;  // of the path's vertex where it starts
} ShadowRay;

#ifdef __cplusplus
}  // namespace oclair
#endif
#endif
