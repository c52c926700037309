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

// A square light of 0.5 below the top of that box, and instead of it many small ones of the same power in all: two triangles
// each.
Mesh lamp();
Mesh small_lamps(std::size_t count);

// The same with vertex normals.
Mesh smooth(const Mesh& mesh);

// The mesh, moved and scaled to stand on the floor of that box, 1.4 high or wide at most.
Mesh in_box(Mesh mesh);

// The mesh, grey on both sides, under the lamps, seen by a pinhole camera inside the box, 512x512.
World world_of(Mesh mesh, Mesh lamps = lamp());

}  // namespace oclair::bench
