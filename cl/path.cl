// The megakernel: one work item owns one pixel and traces `samples` paths of it.
#include "path.h"
#include "pixel.h"

__kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void render(
    SCENE_ARGUMENTS, __global FilmPixel *film, __global FilmMoments *moments, uint base, ulong first_sample, uint samples) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + (uint)get_global_id(0));
  if (!pixel.inside) return;
  for (uint i = 0; i < samples; ++i) {
    ulong key = rng_key(settings->seed, pixel_stream(settings, pixel), first_sample + i);
    PathState path = path_trace(&scene, pixel.x, pixel.y, key);
    film_add(film + pixel.index, HAS(MOMENTS) ? moments + pixel.index : 0, unpack3(path.radiance), path.hit_anything,
             settings->film_exponent);
  }
}
