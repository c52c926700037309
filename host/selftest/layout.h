// The structs of cl/types.h as the host's compiler has laid them out.
#pragma once

#include <string>
#include <vector>

#include "../../cl/types.h"

namespace oclair::test {

struct Place {
  std::string type, member;  // no member: the struct itself
  uint offset, size;
};

// width: 4 or 8, of nodes and blocks. In the order of cl/layout_members.h.
std::vector<Place> host_layout(int width);

// What layout_of_structs (cl/layout.h) says on a device that agrees.
std::vector<uint> layout_numbers(const std::vector<Place>& places);

}  // namespace oclair::test
