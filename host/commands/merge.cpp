#include <unistd.h>

#include <iostream>
#include <memory>

#include "../checkpoint.h"
#include "../checkpoint_lock.h"
#include "../film.h"
#include "../header.h"
#include "../progress.h"
#include "options.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> parts;
  std::optional<fs::path> image, checkpoint;  // at least one
};

// One film in memory and one that is added to it, however many there are. All heads first: what does not go together is said before
// the long work.
Checkpoint merged(const std::vector<std::string>& parts) {
  std::vector<Checkpoint> heads;
  for (const std::string& part : parts) heads.push_back(read_checkpoint_head(part));
  require_mergeable(heads, parts);
  Checkpoint sum = read_checkpoint(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) add_samples(sum, read_checkpoint(parts[i]), parts[i]);
  return sum;
}

void write_image(const fs::path& path, const Checkpoint& checkpoint) {
  const Film& film = checkpoint.film;
  const WorldFilm& window = checkpoint.head.film;
  if (path.extension() == ".png") {
    const std::vector<float> rgb = rgb_of(film);
    const std::span<const float> values(rgb);
    write_png(path, film.width, film.height, {{{values, 3}, {values.subspan(1), 3}, {values.subspan(2), 3}}});
    return;
  }
  Figures figures;
  figures.ranges = checkpoint.ranges;
  figures.rejected = rejected_samples(film);
  write_exr(path, {window.width, window.height, window.crop_x, window.crop_y, window.crop_width, window.crop_height},
            parts_of(film, window.pixel_format, checkpoint.head.moment_name, checkpoint.layers),
            header_attributes(checkpoint.head.attributes, figures, reproducible_date()));
}

Exit merge_files(const MergeOptions& options) {
  std::unique_ptr<CheckpointLock> lock;
  if (options.image) require_writable(*options.image);
  if (options.checkpoint) {
    lock = std::make_unique<CheckpointLock>(*options.checkpoint);
    require_writable(*options.checkpoint);
  }
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  progress.begin("read");
  const Checkpoint sum = merged(options.parts);
  progress.begin("write");
  if (options.checkpoint) write_checkpoint(*options.checkpoint, sum);
  if (options.image) write_image(*options.image, sum);
  progress.end();
  for (const auto& written : {options.checkpoint, options.image})
    if (written) std::cout << written->string() << "\n";
  if (const std::uint64_t rejected = rejected_samples(sum.film))
    std::cerr << "oclair: warning: " << rejected << " samples were not finite, negative or too large and are left out\n";
  return Exit::success;
}

}  // namespace

Command merge_command(CLI::App& program) {
  const auto options = std::make_shared<MergeOptions>();
  CLI::App& line = *program.add_subcommand("merge", "Joins checkpoints of one render to the image of all their samples");
  line.add_option("CHECKPOINT", options->parts, "checkpoints of disjoint samples")->required();
  line.add_option("-o,--output", options->image, "image to write: .exr or .png")->type_name("FILE");
  line.add_option("--checkpoint", options->checkpoint, "checkpoint to write; may be one of those that are read")->type_name("FILE");
  return {&line, [options] {
            if (!options->image && !options->checkpoint) throw Error(Exit::usage, "merge: expected --output or --checkpoint");
            if (options->image && options->image->extension() != ".exr" && options->image->extension() != ".png")
              throw Error(Exit::usage, "--output '" + options->image->string() + "': expected a name in .exr or .png");
            return merge_files(*options);
          }};
}

}  // namespace oclair
