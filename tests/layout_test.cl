#include "../cl/layout.h"

__kernel void layout(uint count, __global uint *result) {
  if (get_global_id(0) < count) layout_of_structs(result);
}
