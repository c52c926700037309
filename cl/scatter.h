// What every scattering model returns when it samples a direction.
#ifndef OCLAIR_SCATTER_H
#define OCLAIR_SCATTER_H

#include "vector.h"

// Directions wo (where the path came from) and wi (where light comes from) leave the surface, in the frame whose z is the
// shading normal on the side of wo: wo.z > 0.
typedef struct Scatter {
  float3 wi;
  float3 weight;  // f cos / pdf; for a delta: its factor over the probability of choosing it; 0 ends the path
  float pdf;      // per solid angle; 0 for a delta
  float eta;      // relative refractive index crossed: transmitted over incident; 1 for a reflection
} Scatter;

#endif
