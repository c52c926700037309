// What the device makes of the structs of types.h.
#ifndef OCLAIR_LAYOUT_H
#define OCLAIR_LAYOUT_H

#include "layout_members.h"
#include "vector.h"

// In the order of the list: of a struct its size, of a member its offset and its size. Addresses are compared, never
// read through.
INLINE void layout_of_structs(__global uint *result) {
#define STRUCT_SIZE(type) result[n++] = (uint)sizeof(type);
#define MEMBER_PLACE(type, member)                                                                     \
  result[n++] = (uint)((__global char *)&((__global type *)result)->member - (__global char *)result); \
  result[n++] = (uint)sizeof(((__global type *)result)->member);
  uint n = 0;
  LAYOUT_LIST(STRUCT_SIZE, MEMBER_PLACE)
#undef STRUCT_SIZE
#undef MEMBER_PLACE
}

#endif
