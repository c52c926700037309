// One work item owns one pixel and says what is seen in it. The results lie in the order of the work items.
#include "aov.h"

__kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void aov(SCENE_ARGUMENTS, __global AovPixel *pixels,
                                                                               ulong base) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + get_global_id(0));
  if (pixel.inside) pixels[get_global_id(0)] = aov_pixel(&scene, pixel);
  else pixels[get_global_id(0)].pixel = NONE;
}
