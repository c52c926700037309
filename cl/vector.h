// Vectors of three floats, the packed ones of the contract, and orthonormal frames.
#ifndef OCLAIR_VECTOR_H
#define OCLAIR_VECTOR_H

#include "types.h"

// A function is compiled again for each function that it is inlined into; out of line once. What is out of line takes by value what its
// caller goes on working with: a variable whose address leaves a function does not stay in registers (docs/performance.md).
#define INLINE static inline __attribute__((always_inline))
#define OUT_OF_LINE static __attribute__((noinline, unused))

#define PI REAL(3.14159265358979324)
#define INV_PI REAL(0.318309886183790672)
#define INFINITE_DISTANCE 1e30f  // in place of infinity: survives -cl-finite-math-only, and no canonical length comes near

INLINE float3 unpack3(packed_float3 p) { return (float3)(p.x, p.y, p.z); }

INLINE packed_float3 pack3(float3 v) {
  packed_float3 p = {v.x, v.y, v.z};
  return p;
}

// a b - c d with an error below 1.5 ulp of the result, whatever cancels (Kahan; Jeannerod, Louvet, Muller 2013).
INLINE float difference_of_products(float a, float b, float c, float d) {
  float cd = c * d;
  float error = fma(-c, d, cd);
  return fma(a, b, -cd) + error;
}

INLINE float3 cross_exact(float3 a, float3 b) {
  return (float3)(difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
                  difference_of_products(a.x, b.y, a.y, b.x));
}

// Brings a vector whose length has drifted by a few ulp back to 1 (one Newton step), so that no drift builds up over 1000 bounces.
INLINE float3 renormalize(float3 d) { return d * fma(-0.5f, dot(d, d), 1.5f); }

INLINE float max_component(float3 v) { return fmax(fmax(v.x, v.y), v.z); }

// Tangent frame: z is the normal. Columns x, y, z are an orthonormal basis.
typedef struct Frame {
  float3 x, y, z;
} Frame;

// Continuous but for the sign of n.z, no division by a small number (Duff et al. 2017).
INLINE Frame frame_from_normal(float3 n) {
  float s = copysign(1.0f, n.z);
  float a = -1.0f / (s + n.z);
  float b = n.x * n.y * a;
  Frame frame;
  frame.x = (float3)(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
  frame.y = (float3)(b, s + n.y * n.y * a, -n.y);
  frame.z = n;
  return frame;
}

INLINE float3 frame_to_local(Frame frame, float3 v) { return (float3)(dot(v, frame.x), dot(v, frame.y), dot(v, frame.z)); }

INLINE float3 frame_to_world(Frame frame, float3 v) { return frame.x * v.x + frame.y * v.y + frame.z * v.z; }

#endif
