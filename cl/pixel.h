// Which pixel a work item owns. Work-groups are square tiles of the crop window, so that neighbouring rays run together.
#ifndef OCLAIR_PIXEL_H
#define OCLAIR_PIXEL_H

#include "scene.h"

typedef struct Pixel {
  uint x, y;      // in the full film
  uint index;     // in the crop window, row by row: where the film keeps it
  bool inside;    // tiles stick out of the crop window
} Pixel;

// index counts all pixels of all tiles, tile by tile: in windows of a few rows they are up to eight times the window's 2^31.
INLINE Pixel pixel_from_index(__global const Settings *settings, ulong index) {
  uint tiles_across = (settings->crop_width + TILE_WIDTH - 1u) / TILE_WIDTH;
  uint tile = (uint)(index / WORK_GROUP_SIZE);
  uint within = (uint)(index % WORK_GROUP_SIZE);
  uint x = tile % tiles_across * TILE_WIDTH + within % TILE_WIDTH;
  uint y = tile / tiles_across * TILE_WIDTH + within / TILE_WIDTH;
  Pixel p;
  p.x = settings->crop_x + x;
  p.y = settings->crop_y + y;
  p.index = y * settings->crop_width + x;
  p.inside = x < settings->crop_width && y < settings->crop_height;
  return p;
}

// Number of the pixel's random streams: by its place in the full film, so that a crop repeats the pixels of the whole.
INLINE uint pixel_stream(__global const Settings *settings, Pixel p) { return p.y * settings->film_width + p.x; }

#endif
