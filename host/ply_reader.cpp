#include "ply_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "number.h"

namespace oclair {

namespace {

// Of one element; real files have some ten. They are searched one by one, and a face of many corners has its attributes once
// for each of its triangles.
constexpr std::size_t MAX_PROPERTIES = 256;

std::optional<Scalar> scalar_named(std::string_view name) {
  constexpr std::array<const char*, 16> NAMES = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                                 "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                                 "float",  "float32", "double", "float64"};
  const auto found = std::find(NAMES.begin(), NAMES.end(), name);
  if (found == NAMES.end()) return std::nullopt;
  return static_cast<Scalar>((found - NAMES.begin()) / 2);
}

}  // namespace

bool is_integer(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

std::string_view next_word(std::string_view& text) {
  constexpr std::string_view BLANKS = " \t\r\n";
  const auto begin = text.find_first_not_of(BLANKS);
  if (begin == std::string_view::npos) return text = {};
  text.remove_prefix(begin);
  const auto word = text.substr(0, text.find_first_of(BLANKS));
  text.remove_prefix(word.size());
  return word;
}

namespace {

Scalar type_in_header(std::string_view& line) {
  const auto word = next_word(line);
  const auto type = scalar_named(word);
  if (!type) fail_ply("header: \"" + std::string(word.substr(0, 40)) + "\" is not a type");
  return *type;
}

void read_header_line(PlyReader& reader, std::string_view line, bool& has_format) {
  const std::string word(next_word(line));
  if (word == "format") {
    const auto format = next_word(line), version = next_word(line);
    if (format == "ascii")
      reader.encoding = Encoding::ascii;
    else if (format == "binary_little_endian")
      reader.encoding = Encoding::little_endian;
    else if (format == "binary_big_endian")
      reader.encoding = Encoding::big_endian;
    else
      fail_ply("header: format \"" + std::string(format.substr(0, 40)) + "\" is not known");
    if (version != "1.0") fail_ply("header: version 1.0 is expected");
    has_format = true;
  } else if (word == "element") {
    PlyElement element;
    element.name = next_word(line);
    const auto count = parse_integer(next_word(line));
    if (!count || *count < 0 || *count >= static_cast<std::int64_t>(NONE))
      fail_ply("header: the number of \"" + element.name.substr(0, 40) + "\" is not one");
    element.count = static_cast<std::uint64_t>(*count);
    reader.elements.push_back(element);
  } else if (word == "property") {
    if (reader.elements.empty()) fail_ply("header: a property stands before the first element");
    PlyProperty property;
    auto after = line;
    if (next_word(after) == "list") {
      line = after;
      property.count_type = type_in_header(line);
      if (!is_integer(*property.count_type)) fail_ply("header: the length of a list is not an integer");
    }
    property.type = type_in_header(line);
    property.name = next_word(line);
    auto& element = reader.elements.back();
    if (element.properties.size() == MAX_PROPERTIES)
      fail_ply("header: \"" + element.name.substr(0, 40) + "\" has more than " + std::to_string(MAX_PROPERTIES) +
               " properties");
    element.properties.push_back(property);
  } else if (word != "comment" && word != "obj_info" && !word.empty()) {
    fail_ply("header: \"" + word.substr(0, 40) + "\" is not known");
  }
}

// Bytes that the rows of an element take at least: of a list, those of its length. In a text a number takes one and the blank
// after it, which the last number of the file may lack.
std::size_t least_size(const PlyReader& reader, const PlyElement& element) {
  const bool ascii = reader.encoding == Encoding::ascii;
  std::size_t row = 0;
  for (const auto& property : element.properties)
    row += ascii ? 2 : size_of(property.count_type.value_or(property.type));
  return element.count * row - ascii;
}

}  // namespace

void read_header(PlyReader& reader) {
  const auto next_line = [&]() -> std::string_view {
    const auto end = reader.rest.find('\n');
    if (end == std::string_view::npos) fail_ply("the header breaks off");
    auto line = reader.rest.substr(0, end);
    reader.rest.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  };
  if (reader.rest.substr(0, 3) != "ply" || next_line() != "ply") fail_ply("it does not begin with \"ply\"");
  bool has_format = false;
  for (auto line = next_line(); line != "end_header"; line = next_line()) read_header_line(reader, line, has_format);
  if (!has_format) fail_ply("header: the format is missing");
  // No count can promise more than the file holds.
  for (const auto& element : reader.elements)
    if (element.count > 0 && (element.properties.empty() || least_size(reader, element) > reader.rest.size()))
      fail_ply("it breaks off before its " + std::to_string(element.count) + " elements \"" + element.name.substr(0, 40) +
               "\"");
}

double read_word(PlyReader& reader, Scalar type) {
  const auto word = next_word(reader.rest);
  if (word.empty()) fail_ply("it breaks off");
  const auto number = parse_number(word);
  if (!number) fail_ply("\"" + std::string(word.substr(0, 40)) + "\" is not a finite number");
  if (is_integer(type) && *number != std::floor(*number))
    fail_ply("\"" + std::string(word.substr(0, 40)) + "\" is not an integer");
  return *number;
}

}  // namespace oclair
