// Typed access to the values of an element. Each function marks the value as asked for, so that what nobody asked for can
// be named (unasked_properties), and throws Error(Exit::scene) at the value's line if its type or range is wrong.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "document.h"

namespace oclair {

// Does not count as asking.
const Property* find_property(const Element& element, const std::string& name);
bool has_property(const Element& element, const std::string& name);

// Where that value stands, or the element if it has none.
std::string where_is(const Element& element, const std::string& name);

double number_property(Element& element, const std::string& name, double missing);  // <float> or <integer>
std::int64_t integer_property(Element& element, const std::string& name, std::int64_t missing, std::int64_t least,
                              std::int64_t greatest);
bool boolean_property(Element& element, const std::string& name, bool missing);
std::optional<std::string> string_property(Element& element, const std::string& name);
// In lower case, and one of `allowed`.
std::string choice_property(Element& element, const std::string& name, const std::string& missing,
                            const std::vector<std::string>& allowed);
std::optional<glm::dvec3> point_property(Element& element, const std::string& name);  // <point> or <vector>
std::optional<glm::dmat4> transform_property(Element& element, const std::string& name);

// Colours are linear sRGB: <rgb>, or <float>, <integer> and <spectrum> for one value in all three channels.
// Reflectance: each channel in [0, 1].
glm::dvec3 reflectance_property(Element& element, const std::string& name, double missing);
// Real or imaginary part of a refractive index: each channel in [0, 1e6].
glm::dvec3 index_property(Element& element, const std::string& name, double missing);
// Bounds of an emission that is not 0: what float32 holds with room for the arithmetic on it.
constexpr double LEAST_EMISSION = 1e-30, GREATEST_EMISSION = 1e30;

// Emission, not negative. A constant <spectrum> is of equal energy, not white: Mitsuba turns 1 into EQUAL_ENERGY.
glm::dvec3 emission_property(Element& element, const std::string& name);

// One warning line for each value of any element that nobody asked for.
std::vector<std::string> unasked_properties(const Document& document);

// Throws Error(Exit::scene) if an object is nested in the element, or referred to, that nobody asked for.
void refuse_unasked_children(const Document& document, const Element& element);

}  // namespace oclair
