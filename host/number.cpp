#include "number.h"

#include <charconv>
#include <cmath>

namespace oclair {

namespace {

constexpr std::string_view BLANKS = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(BLANKS);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(BLANKS) - first + 1);
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  // from_chars calls an underflow out of range too: such a number is 0 to any precision that matters here.
  if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
    const auto exponent = text.find_first_of("eE");
    if (exponent != std::string_view::npos && exponent + 1 < text.size() && text[exponent + 1] == '-') return 0.0;
  }
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  text = trimmed(text);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> split_list(std::string_view text) {
  constexpr std::string_view SEPARATORS = ", \t\r\n";
  std::vector<std::string_view> parts;
  for (auto begin = text.find_first_not_of(SEPARATORS); begin != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(SEPARATORS, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(SEPARATORS, end);
  }
  return parts;
}

}  // namespace oclair
