#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "../checkpoint.h"
#include "../checkpoint_lock.h"
#include "../file_aside.h"
#include "../progress.h"
#include "options.h"
#include "output.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> parts;
  ImageFiles images;
  std::optional<fs::path> checkpoint;  // an image or this, or both
  std::size_t host_memory = FilmLimits().in_memory;  // bytes of film there, at most
};

// Where two films lie that are no larger than the files of the parts: beside what is written, if memory does not hold them.
FilmDirectory place_of(const MergeOptions& options) {
  std::uintmax_t largest = 0;
  for (const std::string& part : options.parts) largest = std::max(largest, fs::file_size(part));
  if (largest <= options.host_memory / 2) return nullptr;
  const fs::path written = options.checkpoint ? *options.checkpoint : options.images.exr ? *options.images.exr : *options.images.png;
  return std::make_shared<const fs::path>(directory_of(written));
}

// One film and one that is added to it at a time, however many there are. All heads first: what does not go together is said
// before the long work.
Checkpoint merged(const MergeOptions& options) {
  const std::vector<std::string>& parts = options.parts;
  std::vector<Checkpoint> heads;
  for (const std::string& part : parts) heads.push_back(read_checkpoint_head(part));
  require_mergeable(heads, parts);
  const FilmDirectory place = place_of(options);
  Checkpoint sum = read_checkpoint(parts.front(), empty_film(place));
  for (std::size_t i = 1; i < parts.size(); ++i) add_samples(sum, read_checkpoint(parts[i], empty_film(place)), parts[i]);
  return sum;
}

// A pattern may have put a part where the result is to go.
void refuse_to_replace(const fs::path& checkpoint, const std::vector<std::string>& parts) {
  std::error_code ignored;
  const bool is_part = std::any_of(parts.begin(), parts.end(),
                                   [&](const std::string& part) { return fs::equivalent(part, checkpoint, ignored); });
  if (checkpoint.empty() || (fs::is_regular_file(checkpoint) && !is_part))
    throw Error(Exit::usage, "--checkpoint '" + checkpoint.string() + "': expected a name that is not there yet, or one of the parts");
}

Exit merge_files(const MergeOptions& options) {
  reproducible_date();  // wrong ones are refused now
  require_distinct(options.images, options.checkpoint, {});
  if (options.checkpoint) refuse_to_replace(*options.checkpoint, options.parts);
  require_writable(options.images);
  std::unique_ptr<CheckpointLock> lock;
  if (options.checkpoint) {
    lock = std::make_unique<CheckpointLock>(*options.checkpoint);
    require_writable(*options.checkpoint);
  }
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  progress.begin("read");
  Checkpoint sum = merged(options);
  sum.kept = true;
  progress.begin("write");
  attempt_all({[&] { write_images(options.images, sum, {}); },
               [&] { if (options.checkpoint) write_checkpoint(*options.checkpoint, sum); }});
  progress.end();
  if (const std::string warning = film_warning(sum.film); !warning.empty()) progress.warning(warning);
  if (options.checkpoint) std::cout << options.checkpoint->string() << "\n";
  print_files(options.images);
  return Exit::success;
}

}  // namespace

Command merge_command(CLI::App& program) {
  const auto options = std::make_shared<MergeOptions>();
  const auto image = std::make_shared<fs::path>();
  CLI::App& line = *program.add_subcommand("merge", "Joins checkpoints of one render to the image of all their samples");
  line.add_option("CHECKPOINT", options->parts, "checkpoints of disjoint samples")->required();
  line.add_option("-o,--output", *image, "image to write: .exr or .png")->type_name("FILE");
  line.add_option("--checkpoint", options->checkpoint, "checkpoint to write; may be one of those that are read")
      ->type_name("FILE");
  add_host_memory(line, options->host_memory);
  return {&line, [options, image] {
            if (image->extension() == ".exr") options->images.exr = *image;
            else if (image->extension() == ".png") options->images.png = *image;
            else if (!image->empty() || !options->checkpoint)
              throw Error(Exit::usage,
                          "--output '" + image->string() + "': expected a name in .exr or .png, or else --checkpoint");
            return merge_files(*options);
          }};
}

}  // namespace oclair
