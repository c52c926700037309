// Choosing one of many: a discrete distribution in integers, for cl/distribution.h.
#pragma once

#include <vector>

#include "world.h"

namespace oclair {

// Cumulative distribution in units of 2^-32 with entry i - 1 <= x < entry i for item i; every item gets at least one unit,
// so that none is lost however small its weight, 0 included. Weights >= 0, not all 0; at most 2^31 of them. The last entry stands for 2^32.
std::vector<uint> distribution(const std::vector<double>& weights);

}  // namespace oclair
