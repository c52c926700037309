// A mesh that was scanned: the Stanford bunny of Debian's package glmark2-data.
#pragma once

#include "../world.h"

namespace oclair::bench {

inline constexpr const char* scan_file = "/usr/share/glmark2/models/bunny.obj";  // as `dpkg -L glmark2-data` says

bool scan_is_there();  // the package is installed
Mesh scan();

}  // namespace oclair::bench
