// Independent small pictures of one scene with one set of choices, and how long they took: what all estimates are made of.
#pragma once

#include <cstddef>
#include <vector>

#include "../render.h"

namespace oclair::tune {

using Picture = std::vector<float>;  // r, g, b of each pixel, W/(m^2 sr)

inline constexpr int level_count = 5;  // partial pictures of a replica: its first 1, 2, 4, 8 and 16 samples
inline constexpr std::size_t leveled_replicas = 4;  // of which these are kept

struct Replicas {
  std::vector<Picture> pictures;      // one a replica: REPLICA_SAMPLES samples a pixel, independent of the others
  std::vector<double> seconds;        // of each
  std::vector<Picture> levels[level_count - 1];  // of the first leveled_replicas, with 1, 2, 4, 8 samples
};

// Renders the next replica; seconds are processor time where the device is a CPU, or else wall time.
// Throws Error(Exit::device).
void add_replica(Renderer& renderer, Replicas& replicas);

}  // namespace oclair::tune
