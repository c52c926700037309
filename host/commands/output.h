// The images of a render, from a film with what its header says: for render and for merge.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "../checkpoint.h"
#include "../header.h"

namespace oclair {

struct ImageFiles {
  std::optional<std::filesystem::path> exr, png;
};

// What of the header depends on the run, not on the samples.
struct RunFigures {
  std::string stopped;  // which limit ended it; empty: none yet
  std::vector<std::pair<std::string, double>> seconds;  // of each phase
};

// Throws Error(Exit::usage) if two of the outputs are one file, or one is among the inputs.
void require_distinct(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs);
void require_distinct(const ImageFiles& files, const std::optional<std::filesystem::path>& checkpoint,
                      const std::vector<std::filesystem::path>& inputs);

// Throws if one of them could not be written now.
void require_writable(const ImageFiles& files);

// Each is tried whatever becomes of the others; then the failure is thrown, or Error(Exit::render_failed) with the messages of several.
void attempt_all(const std::vector<std::function<void()>>& attempts);

// Each is replaced as a whole. Throws Error(Exit::render_failed).
void write_images(const ImageFiles& files, const Checkpoint& checkpoint, const RunFigures& run);

// For standard output: the names, a line each.
void print_files(const ImageFiles& files);

// What the user must know of so many rejected samples; empty: nothing.
std::string rejection_warning(std::uint64_t rejected);

}  // namespace oclair
