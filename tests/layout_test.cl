#include "../cl/types.h"

#include "layout_members.h"

// Addresses are compared, never read through.
#define STRUCT_SIZE(type) result[n++] = (uint)sizeof(type);
#define MEMBER_PLACE(type, member)                                                                             \
  result[n++] = (uint)((__global char *)&((__global type *)result)->member - (__global char *)result);         \
  result[n++] = (uint)sizeof(((__global type *)result)->member);

__kernel void layout(uint count, __global uint *result) {
  if (get_global_id(0) >= count) return;
  uint n = 0;
  LAYOUT_LIST(STRUCT_SIZE, MEMBER_PLACE)
}
