#include "replicas.h"

#include <cmath>

#include "../bench/our_traversal.h"

namespace oclair::tune {
namespace {

static_assert(REPLICA_SAMPLES == 1 << (level_count - 1));

// Mean of the samples that `now` has and `before` has not. Sums are exact integers, so their difference is exact as well.
Picture between(const Film& before, const Film& now) {
  Picture picture(3 * now.pixels.size());
  const int exponent = now.exponent - FILM_FRACTION_BITS;
  for (std::size_t p = 0; p < now.pixels.size(); ++p) {
    const FilmPixel none{}, &first = before.pixels.empty() ? none : before.pixels[p], &last = now.pixels[p];
    const std::uint64_t taken = (now.samples - before.samples) - (last.rejected - first.rejected);
    for (int c = 0; c < 3 && taken > 0; ++c) {
      const std::uint64_t low = last.sum[c][0] - first.sum[c][0];
      const std::uint64_t high = last.sum[c][1] - first.sum[c][1] - (last.sum[c][0] < first.sum[c][0]);
      const double sum = std::ldexp(static_cast<double>(high), 64) + static_cast<double>(low);
      picture[3 * p + c] = static_cast<float>(std::ldexp(sum / static_cast<double>(taken), exponent));
    }
  }
  return picture;
}

}  // namespace

void add_replica(Renderer& renderer, Replicas& replicas) {
  const Film before = read_film(renderer);
  const bool leveled = replicas.pictures.size() < leveled_replicas;
  double seconds = 0.0;
  for (int level = 0; level < level_count; ++level) {
    const uint samples = level == 0 ? 1u : 1u << (level - 1);
    seconds += bench::timed_on(*renderer.device, [&] { render_pass(renderer, samples); })();
    if (leveled && level < level_count - 1) replicas.levels[level].push_back(between(before, read_film(renderer)));
  }
  replicas.pictures.push_back(between(before, read_film(renderer)));
  replicas.seconds.push_back(seconds);
}

}  // namespace oclair::tune
