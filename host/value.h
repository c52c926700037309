// Values in XML: <float>, <integer>, <boolean>, <string>, <rgb>, <spectrum>, <point>, <vector>, <transform>.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "document.h"
#include "substitution.h"
#include "xml_source.h"

namespace oclair {

bool is_value_tag(const std::string& tag);

// The value of such an element; $name has been replaced in the element itself, and is replaced here in the steps of a
// transform. Warnings ("file:line: ...") are appended. Throws Error(Exit::scene).
Value read_value(const Source& source, pugi::xml_node node, Substitution& substitution, std::vector<std::string>& warnings);

}  // namespace oclair
