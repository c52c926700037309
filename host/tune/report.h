// What tune has found as one page of HTML that needs no network: table, plots (SVG), pictures of the differences.
#pragma once

#include <string>

#include "tune.h"

namespace oclair::tune {

std::string report_of(const Result& result);

}  // namespace oclair::tune
