// Host and device must agree on every byte of what crosses the border.
#include <fstream>
#include <regex>
#include <sstream>

#include "kernel.h"
#include "layout.h"

using namespace oclair::test;

namespace {

void compare(int width) {
  const std::vector<Place> host = host_layout(width);
  std::vector<cl_uint> numbers(layout_numbers(host).size());
  run_with({every_feature, width}, "layout_test.cl", "layout", 1, out(numbers));
  std::size_t n = 0;
  for (const Place& place : host) {
    if (!place.member.empty()) {
      EXPECT_EQ(numbers[n++], place.offset) << "offset of " << place.type << "." << place.member;
    }
    EXPECT_EQ(numbers[n++], place.size) << "size of " << place.type << "." << place.member;
  }
}

std::string contract() {
  std::ifstream stream(directory().parent_path() / "cl/types.h");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST(layout_test, host_and_device_agree_for_nodes_of_four) { compare(4); }

TEST(layout_test, host_and_device_agree_for_nodes_of_eight) { compare(8); }

// So the list names every member, and no compiler has room to place one elsewhere.
TEST(layout_test, members_fill_every_struct_without_a_gap) {
  cl_uint end = 0, size = 0;
  std::string type;
  for (const Place& place : host_layout(8)) {
    if (place.member.empty()) {
      EXPECT_EQ(end, size) << "at the end of " << type;
      type = place.type, size = place.size, end = 0;
    } else {
      EXPECT_EQ(place.offset, end) << "before " << type << "." << place.member;
      end = place.offset + place.size;
    }
  }
  EXPECT_EQ(end, size) << "at the end of " << type;
}

TEST(layout_test, every_struct_of_the_contract_is_compared) {
  std::vector<std::string> declared, compared;
  const std::string text = contract();
  const std::regex declaration("(?:typedef|OCLAIR_WIDE) struct (\\w+)");
  for (std::sregex_iterator i(text.begin(), text.end(), declaration), end; i != end; ++i) declared.push_back((*i)[1]);
  for (const Place& place : host_layout(8))
    if (place.member.empty()) compared.push_back(place.type);
  EXPECT_GE(declared.size(), 10u);
  EXPECT_EQ(declared, compared);
}
