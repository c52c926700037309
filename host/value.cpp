#include "value.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <set>

#include "number.h"
#include "transform.h"

namespace oclair {

namespace {

double number_of(const Source& source, pugi::xml_node node, std::string_view text) {
  const auto number = parse_number(text);
  if (!number) refuse(where(source, node), in_brackets(node) + ": \"" + std::string(text) + "\" is not a finite number");
  return *number;
}

// A list of exactly that many numbers.
std::vector<double> numbers_of(const Source& source, pugi::xml_node node, const char* attribute,
                               std::initializer_list<std::size_t> counts) {
  const auto parts = split_list(node.attribute(attribute).value());
  if (std::find(counts.begin(), counts.end(), parts.size()) == counts.end()) {
    std::string expected;
    for (const auto count : counts) expected += (expected.empty() ? "" : " or ") + std::to_string(count);
    refuse(where(source, node), in_brackets(node) + ": \"" + attribute + "\" holds " + std::to_string(parts.size()) +
                                    " numbers, " + expected + " are expected");
  }
  std::vector<double> numbers;
  for (const auto part : parts) numbers.push_back(number_of(source, node, part));
  return numbers;
}

// value="a b c" or value="a" or x, y, z; components that are not given become `missing`.
glm::dvec3 triple_of(const Source& source, pugi::xml_node node, double missing) {
  if (node.attribute("value")) {
    for (const char* axis : {"x", "y", "z"})
      if (node.attribute(axis))
        refuse(where(source, node), in_brackets(node) + ": \"value\" and \"" + axis + "\" exclude each other");
    const auto numbers = numbers_of(source, node, "value", {1, 3});
    return numbers.size() == 1 ? glm::dvec3(numbers[0]) : glm::dvec3(numbers[0], numbers[1], numbers[2]);
  }
  glm::dvec3 result(missing);
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    if (const auto attribute = node.attribute(axes[i])) result[i] = number_of(source, node, attribute.value());
  return result;
}

glm::dvec3 list_of_three(const Source& source, pugi::xml_node node, const char* attribute) {
  const auto numbers = numbers_of(source, node, attribute, {3});
  return {numbers[0], numbers[1], numbers[2]};
}

// The steps in the order of the file: the first acts first.
glm::dmat4 transform_of(const Source& source, pugi::xml_node node, Substitution& substitution,
                        std::vector<std::string>& warnings) {
  glm::dmat4 result(1.0);
  for (const auto step : node.children()) {
    if (says_nothing(step)) continue;
    const std::string at = where(source, step), name = step.name();
    substitute(substitution, step, at);
    glm::dmat4 matrix(1.0);
    if (name == "translate") {
      check_attributes(source, step, {"x", "y", "z", "value"});
      matrix = translation(triple_of(source, step, 0.0));
    } else if (name == "scale") {
      check_attributes(source, step, {"x", "y", "z", "value"});
      matrix = scaling(triple_of(source, step, 1.0));
    } else if (name == "rotate") {
      check_attributes(source, step, {"!angle", "x", "y", "z", "value"});
      const auto axis = triple_of(source, step, 0.0);
      if (axis == glm::dvec3(0.0)) refuse(at, "<rotate>: the axis is zero");
      if (std::abs(glm::dot(axis, axis) - 1.0) > 1e-4)
        warnings.push_back(
            at + ": <rotate>: the axis is not of unit length, so that this is not a rotation (Mitsuba takes it as it is)");
      matrix = rotation(axis, number_of(source, step, step.attribute("angle").value()));
    } else if (name == "lookat") {
      check_attributes(source, step, {"!origin", "!target", "up"});
      const auto up = *step.attribute("up").value() ? list_of_three(source, step, "up") : glm::dvec3(0.0);
      const auto frame = look_at(list_of_three(source, step, "origin"), list_of_three(source, step, "target"), up);
      if (!frame) refuse(at, "<lookat>: target is origin, or up is parallel to the line of sight");
      matrix = *frame;
    } else if (name == "matrix") {
      check_attributes(source, step, {"!value"});
      const auto numbers = numbers_of(source, step, "value", {9, 16});
      const int size = numbers.size() == 16 ? 4 : 3;
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) matrix[column][row] = numbers[row * size + column];
      if (glm::row(matrix, 3) != glm::dvec4(0.0, 0.0, 0.0, 1.0)) refuse(at, "<matrix>: the last row is not 0 0 0 1");
    } else {
      refuse(at, in_brackets(step) + " is not supported (supported: lookat, matrix, rotate, scale, translate)");
    }
    refuse_children(source, step);
    result = matrix * result;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        if (!std::isfinite(result[column][row])) refuse(at, in_brackets(step) + ": the transform overflows");
  }
  return result;
}

}  // namespace

bool is_value_tag(const std::string& tag) {
  static const std::set<std::string> TAGS = {"boolean",  "float",  "integer",   "point", "rgb",
                                             "spectrum", "string", "transform", "vector"};
  return TAGS.count(tag) != 0;
}

Value read_value(const Source& source, pugi::xml_node node, Substitution& substitution, std::vector<std::string>& warnings) {
  const std::string tag = node.name(), at = where(source, node);
  if (tag == "transform") {
    check_attributes(source, node, {"!name"});
    return transform_of(source, node, substitution, warnings);
  }
  refuse_children(source, node);
  if (tag == "point" || tag == "vector") {
    check_attributes(source, node, {"!name", "x", "y", "z", "value"});
    for (const char* axis : {"x", "y", "z"})
      if (!node.attribute("value") && !node.attribute(axis))
        refuse(at, in_brackets(node) + " lacks the attribute \"" + axis + "\"");
    return triple_of(source, node, 0.0);
  }
  if (tag == "spectrum" && node.attribute("filename"))
    refuse(at, "<spectrum>: a file is not supported (supported: one constant value)");
  check_attributes(source, node, {"!name", "!value"});
  const std::string text = node.attribute("value").value();
  if (tag == "rgb") return triple_of(source, node, 0.0);
  if (tag == "float") return number_of(source, node, text);
  if (tag == "string") return text;
  if (tag == "spectrum") {
    if (text.find(':') != std::string::npos)
      refuse(at, "<spectrum>: a list of wavelengths is not supported (supported: one constant value)");
    return number_of(source, node, text);
  }
  if (tag == "integer") {
    const auto number = parse_integer(text);
    if (!number) refuse(at, "<integer>: \"" + text + "\" is not an integer of 64 bits");
    return *number;
  }
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower != "true" && lower != "false") refuse(at, "<boolean>: \"" + text + "\" is neither true nor false");
  return lower == "true";
}

}  // namespace oclair
