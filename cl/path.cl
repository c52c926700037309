// The megakernel: one work item owns one pixel and traces `samples` paths of it.
#include "path.h"
#include "pixel.h"

// Out of line, because PoCL compiles the body of a kernel three times over, and what it calls once.
// Returns the rays that it has traced.
OUT_OF_LINE ulong render_pixel(const Scene *scene, Pixel pixel, __global FilmPixel *film, __global FilmMoments *moments,
                              __global FilmErrors *errors, ulong first_sample, uint samples) {
  __global const Settings *settings = scene->settings;
  ulong rays = 0;
  for (uint i = 0; i < samples; ++i) {
    const Sampler sampler = sampler_begin(settings, pixel_stream(settings, pixel), first_sample + i);
    uint traced = 0;
    PathState path = path_trace(scene, pixel.x, pixel.y, &sampler, &traced);
    rays += traced;
    film_add(film, moments, path_sample(&path, settings), path.hit_anything, settings->film_exponent);
    film_end_sample(film, errors, first_sample + i);
  }
  return rays;
}

// rays: of each work item, over all launches.
// The film's arrays begin with the pixel of that index in the crop window.
__kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void render(
    SCENE_ARGUMENTS, __global FilmPixel *film, __global FilmMoments *moments, __global FilmErrors *errors, __global ulong *rays,
    ulong base, uint first_pixel, ulong first_sample, uint samples) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + get_global_id(0));
  if (!pixel.inside) return;
  const uint index = pixel.index - first_pixel;
  rays[get_global_id(0)] +=
      render_pixel(&scene, pixel, film + index, HAS(MOMENTS) ? moments + index : 0, errors + index, first_sample, samples);
}
