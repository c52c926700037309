// What the kernels compute in: float, or double where they are compiled with -DDOUBLE_PRECISION=1, from the same source.
// types.h includes this behind the structs of buffers: those are float in memory either way, and from here on `float`, its
// vectors and packed_float3 mean the precision of the arithmetic. What lies in a buffer beside those structs is
// stored_float.
#ifndef OCLAIR_PRECISION_H
#define OCLAIR_PRECISION_H

typedef float stored_float;
typedef float2 stored_float2;
typedef float4 stored_float4;
typedef float8 stored_float8;
typedef packed_float3 stored_float3;

#ifndef DOUBLE_PRECISION
#define DOUBLE_PRECISION 0
#endif

#if !DOUBLE_PRECISION
#define REAL(literal) literal##f  // a constant that no float is: 0.1, not 0.5
#define load2(v) (v)              // stored_float2 to float2
#define load4(v) (v)
#define load8(v) (v)
#define store3 pack3  // float3 to stored_float3
#else
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define REAL(literal) literal
#define load2 convert_double2
#define load4 convert_double4
#define load8 convert_double8

// Calls such as fmax(x, 0.0f) would be ambiguous between float and double, so these functions are ours, for doubles; a
// literal is promoted.
#define MIXED static inline __attribute__((overloadable, always_inline))
#define MIXED_PAIR(name, type) \
  MIXED type mixed_##name(type a, type b) { return name(a, b); }
#define MIXED_WITH_NUMBER(name, type) \
  MIXED type mixed_##name(type a, double b) { return name(a, b); }
#define MIXED_TRIPLE(name, type) \
  MIXED type mixed_##name(type a, type b, type c) { return name(a, b, c); }
MIXED_PAIR(fmin, double)
MIXED_WITH_NUMBER(fmin, double2)
MIXED_WITH_NUMBER(fmin, double3)
MIXED_PAIR(fmax, double)
MIXED_PAIR(fmax, double3)
MIXED_WITH_NUMBER(fmax, double3)
MIXED_PAIR(copysign, double)
MIXED_PAIR(copysign, double3)
MIXED_PAIR(nextafter, double)
MIXED_TRIPLE(fma, double)
MIXED_TRIPLE(fma, double2)
MIXED_TRIPLE(fma, double3)
MIXED_TRIPLE(fma, double4)
MIXED_TRIPLE(fma, double8)
MIXED_TRIPLE(clamp, double)
MIXED_TRIPLE(clamp, int)
#undef fmin
#undef fmax
#undef copysign
#undef nextafter
#undef fma
#undef clamp
#define fmin mixed_fmin
#define fmax mixed_fmax
#define copysign mixed_copysign
#define nextafter mixed_nextafter
#define fma mixed_fma
#define clamp mixed_clamp

typedef struct packed_double3 {
  double x, y, z;
} packed_double3;

// Beside unpack3 of vector.h, which is that of packed_double3 here.
MIXED double3 unpack3(stored_float3 p) { return (double3)(p.x, p.y, p.z); }

static inline __attribute__((always_inline)) stored_float3 store3(double3 v) {
  stored_float3 p = {v.x, v.y, v.z};
  return p;
}

#define float double
#define float2 double2
#define float3 double3
#define float4 double4
#define float8 double8
#define int4 long4  // what comparisons of vectors give
#define int8 long8
#define packed_float3 packed_double3
#endif

#endif
