#include "layout.h"

#include <cstddef>

#include "../../cl/layout_members.h"
#include "groups.h"

namespace oclair {
namespace test {
namespace {

template <int WIDTH>
std::vector<Place> layout_of_width() {
  using BvhNode = oclair::BvhNode<WIDTH>;
  using TriangleBlock = oclair::TriangleBlock<WIDTH>;
  std::vector<Place> places;
#define STRUCT_PLACE(type_name) places.push_back({#type_name, "", 0, static_cast<uint>(sizeof(type_name))});
#define MEMBER_PLACE(type_name, member_name)                                                       \
  places.push_back({#type_name, #member_name, static_cast<uint>(offsetof(type_name, member_name)), \
                    static_cast<uint>(sizeof(type_name::member_name))});
  LAYOUT_LIST(STRUCT_PLACE, MEMBER_PLACE)
#undef STRUCT_PLACE
#undef MEMBER_PLACE
  return places;
}

}  // namespace

std::vector<Place> host_layout(int width) { return width == 4 ? layout_of_width<4>() : layout_of_width<8>(); }

std::vector<uint> layout_numbers(const std::vector<Place>& places) {
  std::vector<uint> numbers;
  for (const Place& place : places) {
    if (!place.member.empty()) numbers.push_back(place.offset);
    numbers.push_back(place.size);
  }
  return numbers;
}

}  // namespace test

namespace selftest {

void check_layout(const Session& session, Group& group) {
  const std::vector<uint> host = layout_numbers(host_layout(session.device.bvh_width));
  std::vector<uint> device(host.size());
  run(session, "layout", 1, out(device));
  std::size_t different = 0;
  for (std::size_t i = 0; i < host.size(); ++i) different += host[i] != device[i];
  group.measure("sizes and offsets", static_cast<double>(host.size()));
  group.bound("different", static_cast<double>(different), 0);
}

}  // namespace selftest
}  // namespace oclair
