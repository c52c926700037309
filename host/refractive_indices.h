// Refractive indices of transparent media by name.
#pragma once

#include <optional>
#include <string>

namespace oclair {

// At 589 nm, relative to vacuum; upper and lower case are the same. Nothing for a name that is not in the table.
std::optional<double> find_refractive_index(const std::string& name);

// The names, separated by ", ".
std::string refractive_index_names();

}  // namespace oclair
