// Checkpoints: a film with what it takes to go on rendering it, to join it with others, and to write its image without the
// scene. docs/decisions/checkpoint.md says how the file is made up and why.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "layers.h"
#include "render.h"
#include "sample_range.h"
#include "world.h"

namespace oclair {

// Names and values of all on which the samples depend: two films with equal ones can be joined.
using Identity = std::vector<std::pair<std::string, std::string>>;

// What an image needs besides the film. The attributes are those of its header that do not depend on the samples.
struct ImageHead {
  WorldFilm film;
  std::string moment_name;
  std::vector<std::pair<std::string, std::string>> attributes;
};

struct Checkpoint {
  Identity identity;
  std::vector<SampleRange> ranges;  // ascending, disjoint, none touches the next; each begins with a replica
  Film film;                        // of these samples; its size is the crop of head.film
  ImageHead head;
  std::vector<Layer> layers;        // do not depend on the samples; may be empty
  bool kept = false;                // its user wants it when the render is done, too
};

// Replaces the file as a whole: see file_aside.h. Throws Error(Exit::render_failed).
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

// Throws Error(Exit::render_failed) for a file that is not what write_checkpoint has written, and says which part is not. The film's
// arrays become those of `film`: its memory is used, and new memory is where its own would be (film_vector.h).
Checkpoint read_checkpoint(const std::filesystem::path& path, Film film = {});

// The same without the arrays: the film has its size, exponent and number of samples, the layers their names.
Checkpoint read_checkpoint_head(const std::filesystem::path& path);

// What its film comes to, for who needs no pixel of it.
struct CheckpointSummary {
  Checkpoint head;  // as of read_checkpoint_head
  bool moments = false;
  std::uint64_t rejected = 0;   // rejected_samples
  std::optional<double> error;  // image_error
};

// Every byte is checked as by read_checkpoint, which throws the same, in the memory of some MiB.
CheckpointSummary summarize_checkpoint(const std::filesystem::path& path);

// Whether a file begins like a checkpoint: one that does not is none of ours to replace.
bool begins_like_checkpoint(const std::filesystem::path& path);

// The identity, and what else must agree for the arrays of two checkpoints to go together. Looks at no array.
Identity with_film(const Checkpoint& checkpoint);

// Throws Error(Exit::render_failed) with the name, and each entry that differs with both values.
void require_same(const Identity& expected, const Identity& found, const std::string& name);

// Throws Error(Exit::render_failed) unless the checkpoints, named thus in messages, belong to one render and their samples are
// disjoint. Looks at no array: heads will do.
void require_mergeable(std::span<const Checkpoint> heads, std::span<const std::string> names);

// Adds the samples of `part`, named thus in messages; what does not depend on the samples is that of the part with the first
// sample, and the layers that this one lacks are the other's. The sums are exact: any order of additions gives the same
// bits, those of one render of all samples. Throws as above.
void add_samples(Checkpoint& sum, Checkpoint part, const std::string& name);

}  // namespace oclair
