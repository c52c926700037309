// What a surface is made of at one point: which material of a blend, and what its textures say there.
#ifndef OCLAIR_MATERIAL_H
#define OCLAIR_MATERIAL_H

#include "rng.h"
#include "texture.h"

#define SIGMA_MAX 1.41421356f  // of Oren-Nayar: what alpha = 2 of a scene file says

// Walks a blend down to one of its materials: the second with the probability of the weight. In the mean over `bits` that is the
// blend; both light sampling and scattering see the chosen one, so that its density is its own.
INLINE uint material_select(const Scene *scene, uint index, const TexturePoint *at, uint bits) {
  if (!HAS(BLEND)) return index;
  while (scene->materials[index].kind == MATERIAL_BLEND) {
    __global const Material *blend = scene->materials + index;
    float weight = HAS_TEXTURES && blend->weight_texture != 0u ? texture_number(scene, blend->weight_texture, at) : blend->weight;
    index = rng_unit(bits) < weight ? blend->second : blend->first;
    bits = (uint)rng_mix(bits);
  }
  return index;
}

INLINE float material_transparency(const Scene *scene, uint index, const TexturePoint *at) {
  __global const Material *material = scene->materials + index;
  if (HAS_TEXTURES && material->opacity_texture != 0u)
    return fmin(fmax(1.0f - texture_number(scene, material->opacity_texture, at), 0.0f), 1.0f);
  return material->transparency;
}

// Textures take the place of the constants. Reflectances are brought into [0, 1] (NaN becomes 0): an image may say anything.
INLINE Material material_at(const Scene *scene, uint index, const TexturePoint *at) {
  Material m = scene->materials[index];
  if (!HAS_TEXTURES) return m;
  if (m.reflectance_texture != 0u)
    m.reflectance = store3(fmin(fmax(texture_eval(scene, m.reflectance_texture, at), 0.0f), 1.0f));
  if (m.transmittance_texture != 0u)
    m.transmittance = store3(fmin(fmax(texture_eval(scene, m.transmittance_texture, at), 0.0f), 1.0f));
  if (m.roughness_texture != 0u) {
    float most = m.kind == MATERIAL_DISNEY ? 1.0f : SIGMA_MAX;
    m.roughness = fmin(fmax(m.roughness * texture_number(scene, m.roughness_texture, at), 0.0f), most);
  }
  return m;
}

#endif
