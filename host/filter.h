// The film's reconstruction filter as the table that cl/filter.h samples.
#pragma once

#include <array>
#include <vector>

#include "world.h"

namespace oclair {

// Table of cl/filter.h.
std::vector<std::array<float, 2>> filter_table(FilterKind kind, double radius, double stddev);

}  // namespace oclair
