// Generated meshes to measure on, in world space: the same for the same number, on every machine. Every edge belongs to two
// triangles, and a box around everything closes the scene: every ray from inside hits.
#pragma once

#include <cstddef>

#include "../world.h"

namespace oclair::bench {

inline constexpr std::size_t least_triangles = 1000;

// Hills with boulders on them in a box of [-1, 1]^3: `triangles` of them, rounded down to an even number.
Mesh terrain(std::size_t triangles);

// Thin sticks, tetrahedra of 0.25 x 0.004, in the same box: `triangles` of them, rounded down to a multiple of 4.
Mesh sticks(std::size_t triangles);

// The mesh, moved and scaled to stand on the floor of that box, 1.4 high or wide at most.
Mesh in_box(Mesh mesh);

// The mesh, grey on both sides, under a square light, seen by a pinhole camera inside the box, 512x512.
World world_of(Mesh mesh);

}  // namespace oclair::bench
