// Numbers in text: what the scene format calls a number, independent of the locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace oclair {

// Decimal floating point, blanks and one '+' allowed in front, blanks behind; nothing else may follow. Overflow, nan and
// infinity give nothing: no value of a scene may be one.
std::optional<double> parse_number(std::string_view text);

// Decimal integer of 64 bits, blanks around it allowed, no '+'.
std::optional<std::int64_t> parse_integer(std::string_view text);

// Parts of a list separated by commas and blanks.
std::vector<std::string_view> split_list(std::string_view text);

}  // namespace oclair
