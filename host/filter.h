// The film's reconstruction filter as the table that cl/filter.h samples.
#pragma once

#include <vector>

#include "world.h"

namespace oclair {

// Table of cl/filter.h.
std::vector<FilterEntry> filter_table(FilterKind kind, double radius, double stddev);

}  // namespace oclair
