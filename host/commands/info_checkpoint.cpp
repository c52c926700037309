#include <iostream>

#include "../checkpoint.h"
#include "commands.h"
#include "report.h"

namespace oclair {

// All of it is read, so that a damaged one is refused.
Exit info_checkpoint(const std::filesystem::path& path) {
  const CheckpointSummary summary = summarize_checkpoint(path);
  const Checkpoint& checkpoint = summary.head;
  const Film& film = checkpoint.film;
  const WorldFilm& window = checkpoint.head.film;
  row("checkpoint") << path.string() << "\n";
  for (const auto& [name, value] : checkpoint.identity) row(one_line(name)) << one_line(value) << "\n";
  row("film") << film.width << "x" << film.height;
  if (film.width != window.width || film.height != window.height)
    std::cout << " at " << window.crop_x << "," << window.crop_y << " of " << window.width << "x" << window.height;
  std::cout << ", exponent " << film.exponent << (summary.moments ? ", with second moments" : "") << "\n";
  for (const SampleRange& range : checkpoint.ranges) row("samples") << to_string(range) << "\n";
  row("samples per pixel") << film.samples << ", " << film.replicas << " complete replicas\n";
  row("rejected samples") << summary.rejected << "\n";
  row("rays") << film.rays << "\n";
  if (summary.error) row("estimated error") << *summary.error << "\n";
  for (const Layer& layer : checkpoint.layers) row("layer") << one_line(layer.name) << "\n";
  for (const auto& [name, value] : checkpoint.head.attributes)
    row("header") << one_line(name) << ": " << one_line(value) << "\n";
  row("kept") << (checkpoint.kept ? "yes: stays when its render is done" : "no: goes when its render is done") << "\n";
  return Exit::success;
}

}  // namespace oclair
