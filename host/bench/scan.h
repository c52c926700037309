// A mesh that was scanned: the Stanford bunny of Debian's package glmark2-data.
#pragma once

#include <optional>

#include "../world.h"

namespace oclair::bench {

inline constexpr const char* scan_file = "/usr/share/glmark2/models/bunny.obj";  // as `dpkg -L glmark2-data` says

std::optional<Mesh> scan();  // nothing where the package is not installed

}  // namespace oclair::bench
