#include "property.h"

#include <algorithm>
#include <cctype>

namespace oclair {

namespace {

// Linear sRGB (white D65) of the spectrum that is 1 W/(m^2 sr nm) everywhere, CIE 1931 observer; measured in Mitsuba 3.9.1,
// variant scalar_rgb.
constexpr glm::dvec3 EQUAL_ENERGY(1.20479393, 0.948291004, 0.908916056);

// The property if it is there and of one of the tags.
const Property* find(Element& element, const std::string& name, const std::vector<std::string>& tags) {
  for (auto& property : element.properties) {
    if (property.name != name) continue;
    property.asked = true;
    if (std::find(tags.begin(), tags.end(), property.tag) == tags.end()) {
      std::string expected;
      for (const auto& tag : tags) expected += (expected.empty() ? "<" : tag == tags.back() ? " or <" : ", <") + tag + ">";
      refuse(property.where,
             "\"" + name + "\" of " + describe(element) + " is a <" + property.tag + ">, " + expected + " is expected");
    }
    return &property;
  }
  for (const auto& child : element.children)
    if (child.name == name)
      refuse(child.where, "\"" + name + "\" of " + describe(element) + " is an object, <" + tags[0] + "> is expected");
  return nullptr;
}

const std::vector<std::string> COLOUR_TAGS = {"rgb", "float", "integer", "spectrum"};

glm::dvec3 triple(const Property& property) {
  if (const auto* rgb = std::get_if<glm::dvec3>(&property.value)) return *rgb;
  if (const auto* number = std::get_if<double>(&property.value)) return glm::dvec3(*number);
  return glm::dvec3(static_cast<double>(std::get<std::int64_t>(property.value)));
}

glm::dvec3 colour_between(Element& element, const std::string& name, double missing, double greatest,
                          const std::string& range) {
  const auto* property = find(element, name, COLOUR_TAGS);
  if (!property) return glm::dvec3(missing);
  const auto value = triple(*property);
  for (int i = 0; i < 3; ++i)
    if (!(value[i] >= 0.0 && value[i] <= greatest))
      refuse(property->where, "\"" + name + "\" of " + describe(element) + " lies outside " + range);
  return value;
}

}  // namespace

const Property* find_property(const Element& element, const std::string& name) {
  for (const auto& property : element.properties)
    if (property.name == name) return &property;
  return nullptr;
}

bool has_property(const Element& element, const std::string& name) { return find_property(element, name) != nullptr; }

std::string where_is(const Element& element, const std::string& name) {
  const auto* property = find_property(element, name);
  return property ? property->where : element.where;
}

double number_property(Element& element, const std::string& name, double missing) {
  const auto* property = find(element, name, {"float", "integer"});
  return property ? triple(*property).x : missing;
}

std::int64_t integer_property(Element& element, const std::string& name, std::int64_t missing, std::int64_t least,
                              std::int64_t greatest) {
  const auto* property = find(element, name, {"integer"});
  if (!property) return missing;
  const auto value = std::get<std::int64_t>(property->value);
  if (value < least || value > greatest)
    refuse(property->where, "\"" + name + "\" of " + describe(element) + " is " + std::to_string(value) + ", " +
                                std::to_string(least) + " to " + std::to_string(greatest) + " is expected");
  return value;
}

bool boolean_property(Element& element, const std::string& name, bool missing) {
  const auto* property = find(element, name, {"boolean"});
  return property ? std::get<bool>(property->value) : missing;
}

std::optional<std::string> string_property(Element& element, const std::string& name) {
  const auto* property = find(element, name, {"string"});
  if (!property) return std::nullopt;
  return std::get<std::string>(property->value);
}

std::string choice_property(Element& element, const std::string& name, const std::string& missing,
                            const std::vector<std::string>& allowed) {
  auto value = string_property(element, name).value_or(missing);
  std::transform(value.begin(), value.end(), value.begin(), [](unsigned char c) { return std::tolower(c); });
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return value;
  std::string list;
  for (const auto& choice : allowed) list += (list.empty() ? "" : ", ") + choice;
  refuse(where_is(element, name),
         name + "=\"" + value + "\" of " + describe(element) + " is not supported (supported: " + list + ")");
}

std::optional<glm::dvec3> point_property(Element& element, const std::string& name) {
  const auto* property = find(element, name, {"point", "vector"});
  if (!property) return std::nullopt;
  return std::get<glm::dvec3>(property->value);
}

std::optional<glm::dmat4> transform_property(Element& element, const std::string& name) {
  const auto* property = find(element, name, {"transform"});
  if (!property) return std::nullopt;
  const auto& matrix = std::get<glm::dmat4>(property->value);
  return matrix;
}

glm::dvec3 reflectance_property(Element& element, const std::string& name, double missing) {
  return colour_between(element, name, missing, 1.0, "[0, 1]");
}

glm::dvec3 index_property(Element& element, const std::string& name, double missing) {
  return colour_between(element, name, missing, 1e6, "[0, 1e6]");
}

glm::dvec3 emission_property(Element& element, const std::string& name) {
  const auto* property = find(element, name, COLOUR_TAGS);
  if (!property) return glm::dvec3(1.0);
  const auto value = triple(*property) * (property->tag == "spectrum" ? EQUAL_ENERGY : glm::dvec3(1.0));
  for (int i = 0; i < 3; ++i) {
    if (!(value[i] >= 0.0)) refuse(property->where, "\"" + name + "\" of " + describe(element) + " is negative");
    if (value[i] > 0.0 && !(value[i] >= LEAST_EMISSION && value[i] <= GREATEST_EMISSION))
      refuse(property->where, "\"" + name + "\" of " + describe(element) + " is neither 0 nor within [1e-30, 1e30]");
  }
  return value;
}

std::vector<std::string> unasked_properties(const Document& document) {
  std::vector<std::string> lines;
  for (const auto& element : document.elements)
    for (const auto& property : element.properties)
      if (!property.asked)
        lines.push_back(property.where + ": parameter \"" + property.name + "\" of " + describe(element) + " is not used");
  return lines;
}

void refuse_unasked_children(const Document& document, const Element& element) {
  for (const auto& child : element.children)
    if (!child.asked)
      refuse(child.where, describe(document.elements[child.element]) + (child.name.empty() ? "" : " \"" + child.name + "\"") +
                              " is not supported in " + describe(element));
}

}  // namespace oclair
