#include <set>

#include "../host/render.h"
#include "extremes.h"
#include "kernel.h"
#include "random.h"

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
  record_law("X48");
}

TEST(pixel_test, a_work_group_is_a_square_tile) {
  const std::vector<Item> all = items(window(0, 0, 64, 24));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t tile = i / 64;
    EXPECT_EQ(all[i].x / 8, tile % 8);
    EXPECT_EQ(all[i].y / 8, tile / 8);
  }
}

// Extreme X46: windows of 2^31 pixels, whose tiles have up to 2^34 work items. Without a film: 64-bit arithmetic tells who owns
// which pixel.
TEST(pixel_test, work_items_of_2_to_the_31_pixels_own_those_of_64_bit_arithmetic) {
  Random random(1);
  struct Case { std::uint64_t width, height; };
  constexpr std::uint64_t most = std::uint64_t{1} << 31;
  for (const Case c : {Case{65536, 32768}, {32768, 65536}, {46340, 46341}, {most, 1}, {1, most}, {most / 2, 2}}) {
    Settings s{};
    s.film_width = s.crop_width = static_cast<uint>(c.width);
    s.film_height = s.crop_height = static_cast<uint>(c.height);
    const std::uint64_t across = (c.width + 7) / 8, items = padded_pixels(s);
    ASSERT_EQ(items, across * ((c.height + 7) / 8) * 64);
    std::vector<cl_ulong> index;
    for (cl_ulong i = 0; i < 64; ++i) index.insert(index.end(), {i, items - 1 - i, items / 2 + i});
    for (cl_ulong power = 64; power < items; power *= 2) index.insert(index.end(), {power, power - 1});
    while (index.size() < count_or_small(20000, 300)) index.push_back(random.engine() % items);
    std::vector<Item> result(index.size());
    run("pixel_test.cl", "pixels_at", index.size(), std::vector<Settings>{s}, index, out(result));
    for (std::size_t i = 0; i < index.size(); ++i) {
      const std::uint64_t tile = index[i] / 64, within = index[i] % 64;
      const std::uint64_t x = tile % across * 8 + within % 8, y = tile / across * 8 + within / 8;
      const bool inside = x < c.width && y < c.height;
      ASSERT_EQ(result[i].inside != 0, inside) << index[i];
      if (!inside) continue;
      EXPECT_EQ(result[i].x, x) << index[i];
      EXPECT_EQ(result[i].y, y) << index[i];
      EXPECT_EQ(result[i].index, y * c.width + x) << index[i];
      EXPECT_EQ(result[i].stream, y * c.width + x) << index[i];
    }
  }
  record_law("X46");
}
