// Layers that say what is seen in each pixel, not how bright it is ("arbitrary output variables"), for compositing and
// denoising.
#pragma once

#include <string_view>

#include "layers.h"
#include "render.h"

namespace oclair {

struct Aovs {
  bool albedo = false, normal = false, depth = false, uv = false, primitive = false;

  bool any() const { return albedo || normal || depth || uv || primitive; }
};

// Layers that render_aovs makes.
std::size_t channel_count(const Aovs& wanted);

// The layers that are wanted, in the order of Aovs: albedo.R, G, B; normal.X, Y, Z (world space); depth.Z (in the scene's
// lengths); uv.U, V; primitive.id (an integer). Means over the first AOV_SAMPLES samples of each pixel, but for the
// primitive; docs/image-files.md defines them. They depend on the scene, its seed and its film alone. uv wants a scene with
// World::keep_uvs. The scene and the BVH are those of the renderer. Throws Error(Exit::device).
std::vector<Layer> render_aovs(const Renderer& renderer, const Scene& scene, const Bvh& bvh, const Aovs& wanted);

// Where a layer of that name stands among those of render_aovs; behind them all if it is none of theirs.
std::size_t aov_order(std::string_view layer);

}  // namespace oclair
