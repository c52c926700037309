// The head of a checkpoint file: JSON that says all but the arrays. docs/decisions/checkpoint.md describes it.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "checkpoint.h"

namespace oclair {

inline constexpr std::size_t MAX_HEAD = std::size_t{1} << 24;  // bytes: a command line of the longest, and room

// An array of the file, in the order in which they follow the head.
struct ArrayEntry {
  std::string name;
  std::uint64_t bytes = 0;
  std::string checksum;
};

struct CheckpointHead {
  Checkpoint checkpoint;  // without its arrays
  std::vector<ArrayEntry> arrays;
};

// What is wrong with a head; the caller adds which file.
struct CheckpointHeadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string head_text(const Checkpoint& checkpoint, const std::vector<ArrayEntry>& arrays);

// Every number is in its range, the samples are those of the ranges, the crop lies in the film; of the arrays nothing is
// checked. Throws CheckpointHeadError.
CheckpointHead parse_head(std::string_view text);

}  // namespace oclair
