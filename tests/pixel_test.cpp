#include <set>

#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Settings window(uint x, uint y, uint width, uint height) {
  Settings s{};
  s.film_width = x + width + 3;
  s.film_height = y + height + 2;
  s.crop_x = x;
  s.crop_y = y;
  s.crop_width = width;
  s.crop_height = height;
  return s;
}

struct Item {
  cl_uint x, y, index, inside, stream;
};

std::vector<Item> items(const Settings& settings) {
  const std::size_t across = (settings.crop_width + 7) / 8, down = (settings.crop_height + 7) / 8;
  std::vector<Item> result(across * down * 64);
  run("pixel_test.cl", "pixels", result.size(), std::vector<Settings>{settings}, out(result));
  return result;
}

}  // namespace

TEST(pixel_test, work_items_cover_every_pixel_of_the_window_once) {
  std::vector<Settings> windows = {window(0, 0, 1, 1), window(0, 0, 1, 57), window(3, 5, 13, 7), window(100, 0, 64, 64), window(8, 8, 9, 8)};
  if (!small_inputs()) windows.insert(windows.end(), {window(0, 0, 65536, 1), window(7, 9, 1, 65536)});
  for (const Settings& s : windows) {
    std::vector<int> count(std::size_t{s.crop_width} * s.crop_height);
    std::set<cl_uint> streams;
    for (const Item& item : items(s)) {
      if (!item.inside) continue;
      ASSERT_LT(item.index, count.size());
      ++count[item.index];
      EXPECT_EQ(item.x, s.crop_x + item.index % s.crop_width);
      EXPECT_EQ(item.y, s.crop_y + item.index / s.crop_width);
      EXPECT_EQ(item.stream, item.y * s.film_width + item.x);
      streams.insert(item.stream);
    }
    EXPECT_EQ(std::count(count.begin(), count.end(), 1), static_cast<std::ptrdiff_t>(count.size()));
    EXPECT_EQ(streams.size(), count.size());
  }
}

TEST(pixel_test, a_work_group_is_a_square_tile) {
  const std::vector<Item> all = items(window(0, 0, 64, 24));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t tile = i / 64;
    EXPECT_EQ(all[i].x / 8, tile % 8);
    EXPECT_EQ(all[i].y / 8, tile / 8);
  }
}
