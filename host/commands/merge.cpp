#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <numeric>

#include "../checkpoint.h"
#include "../checkpoint_lock.h"
#include "../file_aside.h"
#include "../film.h"
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
  // In the order of their samples: what several parts have and only one can give is then the first one's, however they are
  // named.
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return heads[a].ranges.front().first < heads[b].ranges.front().first; });
  const FilmDirectory place = place_of(options);
  Checkpoint sum = read_checkpoint(parts[order.front()], empty_film(place));
  for (std::size_t i = 1; i < order.size(); ++i)
    add_samples(sum, read_checkpoint(parts[order[i]], empty_film(place)), parts[order[i]]);
  return sum;
}

// Samples of replicas that are not complete; empty: there are none.
std::string replica_warning(const Checkpoint& sum) {
  const std::uint64_t outside = sum.film.samples - sum.film.replicas * REPLICA_SAMPLES;
  if (outside == 0) return "";
  std::string ranges;
  for (const SampleRange& range : sum.ranges)
    if (range.count % REPLICA_SAMPLES != 0) ranges += (ranges.empty() ? "" : " ") + to_string(range);
  return std::to_string(outside) + " of the " + std::to_string(sum.film.samples) +
         " samples per pixel count in the image and not in its standard error, since a range (" + ranges +
         ") holds no multiple of " + std::to_string(REPLICA_SAMPLES);
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
  require_distinct(options.images, {}, {options.parts.begin(), options.parts.end()});
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
  if (const std::string warning = rejection_warning(rejected_samples(sum.film)); !warning.empty()) progress.warning(warning);
  if (const std::string warning = replica_warning(sum); !warning.empty()) progress.warning(warning);
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
