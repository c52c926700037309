// Light from all around: an image in longitude and latitude that is sampled by its luminance.
//
// The image's column u in [0, 1) is the longitude in turns, atan2(x, -z), its row v the angle from +y in half turns, in the
// image's own frame; texel (i, j) stands at u = (i + 1/2)/W, v = j/(H - 1), and is interpolated bilinearly between (as in
// Mitsuba 3). The cells between texels are what is sampled: a row of cells by the marginal distribution, a cell of it by the
// conditional one, a direction of the cell uniformly by solid angle. environment_cdf holds H - 1 entries of the marginal
// distribution, then W for each row of cells, all as light_cdf.
#ifndef OCLAIR_ENVIRONMENT_H
#define OCLAIR_ENVIRONMENT_H

#include "distribution.h"
#include "texture.h"
#include "warp.h"

INLINE float3 environment_to_local(__global const Settings *settings, float3 d) {
  return (float3)(dot(unpack3(settings->environment_x), d), dot(unpack3(settings->environment_y), d),
                  dot(unpack3(settings->environment_z), d));
}

INLINE float3 environment_to_world(__global const Settings *settings, float3 d) {
  return unpack3(settings->environment_x) * d.x + unpack3(settings->environment_y) * d.y + unpack3(settings->environment_z) * d.z;
}

// Cell (x, y) of the image in which a direction lies, and where in it.
typedef struct EnvironmentCell {
  uint x, y;
  float2 within;
} EnvironmentCell;

INLINE EnvironmentCell environment_cell(const Texture *image, float3 d) {
  uint columns = image->width, rows = max(image->height, 2u) - 1u;
  float turns = atan2(d.x, -d.z) * (0.5f * INV_PI);  // [-1/2, 1/2]
  float x = (turns < 0.0f ? turns + 1.0f : turns) * columns - 0.5f;
  x = x < 0.0f ? x + columns : x;
  float y = atan2(sqrt(d.x * d.x + d.z * d.z), d.y) * INV_PI * rows;  // the arc cosine has no digits at the poles
  EnvironmentCell cell;
  cell.x = min((uint)x, columns - 1u);
  cell.y = min((uint)y, rows - 1u);
  cell.within = fmin((float2)(x - cell.x, y - cell.y), 1.0f);
  return cell;
}

INLINE float3 environment_texel(const Scene *scene, const Texture *image, EnvironmentCell cell) {
  ulong next = cell.x + 1u == image->width ? 0ul : cell.x + 1ul;
  ulong row0 = (ulong)cell.y * image->width, row1 = (ulong)min(cell.y + 1u, image->height - 1u) * image->width;
  float3 above = mix(texel(scene, image, row0 + cell.x), texel(scene, image, row0 + next), cell.within.x);
  float3 below = mix(texel(scene, image, row1 + cell.x), texel(scene, image, row1 + next), cell.within.x);
  return mix(above, below, cell.within.y);
}

// Difference of the cosines at the edges of row y of cells, as a product, which does not cancel. Counted from the nearer pole: the
// sine of an angle near pi has no digits.
INLINE float environment_height(uint rows, uint y) {
  uint from_pole = min(y, rows - 1u - y);
  float half_step = 0.5f * PI / rows;
  return 2.0f * sin((2.0f * (float)from_pole + 1.0f) * half_step) * sin(half_step);
}

INLINE float environment_cell_pdf(const Scene *scene, const Texture *image, uint x, uint y) {
  uint columns = image->width, rows = max(image->height, 2u) - 1u;
  __global const uint *conditional = scene->environment_cdf + rows + (ulong)y * columns;
  float probability = distribution_probability(scene->environment_cdf, rows, y) * distribution_probability(conditional, columns, x);
  return probability / (2.0f * PI / columns * environment_height(rows, y));
}

// Radiance from direction d, unit, in world space.
OUT_OF_LINE float3 environment_radiance(const Scene *scene, float3 d) {
  __global const Settings *settings = scene->settings;
  Texture image = scene->textures[settings->environment_texture - 1u];
  EnvironmentCell cell = environment_cell(&image, environment_to_local(settings, d));
  return unpack3(settings->environment) * environment_texel(scene, &image, cell);
}

// Density per solid angle with which environment_sample draws d.
OUT_OF_LINE float environment_pdf(const Scene *scene, float3 d) {
  __global const Settings *settings = scene->settings;
  Texture image = scene->textures[settings->environment_texture - 1u];
  EnvironmentCell cell = environment_cell(&image, environment_to_local(settings, d));
  return environment_cell_pdf(scene, &image, cell.x, cell.y);
}

// Draws a direction; *pdf is its density. The high half of the random bits chooses across, the low half down.
OUT_OF_LINE float3 environment_sample(const Scene *scene, ulong bits, float *pdf) {
  __global const Settings *settings = scene->settings;
  Texture image = scene->textures[settings->environment_texture - 1u];
  uint columns = image.width, rows = max(image.height, 2u) - 1u;
  float across, down;  // where in the cell
  uint y = distribution_sample(scene->environment_cdf, rows, (uint)bits, &down);
  uint x = distribution_sample(scene->environment_cdf + rows + (ulong)y * columns, columns, (uint)(bits >> 32), &across);
  *pdf = environment_cell_pdf(scene, &image, x, y);
  // h = 1 - cos of the angle from the nearer pole: it runs linearly through the cell and keeps its digits.
  bool south = 2u * y + 1u > rows;
  float s = sin((south ? rows - 1u - y : y) * (0.5f * PI / rows));
  float h = 2.0f * s * s + (south ? 1.0f - down : down) * environment_height(rows, y);
  float2 around = warp_circle(((float)x + 0.5f + across) / columns);
  float sine = sqrt(h * (2.0f - h)), height = south ? h - 1.0f : 1.0f - h;
  return environment_to_world(settings, (float3)(sine * around.y, height, -sine * around.x));
}

#endif
