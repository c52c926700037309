// What the header of an image says of how it was made; docs/image-files.md lists its attributes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device.h"
#include "image.h"
#include "sample_range.h"
#include "scene.h"

namespace oclair {

// Names and values of what does not depend on the samples. Checkpoints keep it.
using HeaderTexts = std::vector<std::pair<std::string, std::string>>;

// What neither the placed scene nor the device knows.
struct Origin {
  std::string scene;         // name of its file, without directories
  std::string scene_hash;    // of all its files
  std::string command_line;  // command_line()
  std::string options;       // longest path and definitions
};

// What was asked for at the price of accuracy, on the command line or by the scene's materials: "none", or names.
std::string approximation_names(const Scene& scene);

// Names of the features, separated by blanks, as the header has them.
std::string feature_names(Features features);

// As --sampler takes them: "independent", "sobol".
const char* name_of(SamplerKind sampler);

// As --arithmetic takes them: "float", "double".
const char* arithmetic_name(const Scene& scene);

HeaderTexts header_texts(const Origin& origin, const Scene& scene, const Device& device);

// What depends on the samples, or on how long they took.
struct Figures {
  std::vector<SampleRange> ranges;  // ascending and disjoint
  std::uint64_t rejected = 0;       // samples, in all pixels together
  std::optional<std::uint64_t> rays;
  std::optional<double> estimated_error;                // of the image, as --error counts it
  std::optional<double> standard_error_unit;            // that of standard errors (film.h); nothing: there are none
  std::string stopped;                                  // which limit ended the render; empty: not said
  std::vector<std::pair<std::string, double>> seconds;  // of each phase
};

// The attributes. With a date (seconds since 1970, as reproducible_date() has it) nothing is said that can differ between
// two equal runs, or a run and its parts merged: not the command line, what ended it, and the seconds.
ImageAttributes header_attributes(const HeaderTexts& texts, const Figures& figures, std::optional<std::int64_t> date);

// The environment's SOURCE_DATE_EPOCH (reproducible-builds.org/specs/source-date-epoch). Throws Error(Exit::usage) if it is
// no number.
std::optional<std::int64_t> reproducible_date();

// Of this process, quoted for a shell where that is needed.
std::string command_line();

}  // namespace oclair
