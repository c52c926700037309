// What is refused before it is allocated.
#include "../host/error.h"
#include "../host/render.h"
#include "../host/upload.h"
#include "extremes.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

std::string refusal(const std::vector<BufferPlan>& plan, std::size_t film, std::size_t moments, std::size_t errors = 0,
                    std::size_t whole = 0, std::size_t layers = 0, const FilmDirectory& directory = {}) {
  try {
    check_memory(device(), plan, {8, 1, film, moments, errors, whole, layers, directory});
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::device);
    return error.what();
  }
  return "";
}

std::size_t largest_buffer() { return device().device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>(); }
std::size_t all_memory() { return device().device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>(); }

}  // namespace

TEST(upload_test, every_buffer_has_the_devices_limit_for_itself) {
  const std::size_t most = largest_buffer(), half = std::min(most, all_memory() / 2 - 16);
  ASSERT_LT(most / 2 + 1, half);
  EXPECT_EQ(refusal({{"camera", nullptr, 16}}, most / 2 + 1, half - 1), "");  // together more than one buffer may have
  EXPECT_EQ(refusal({}, most + 1, 0).find("device memory: buffer \"film\" takes "), 0u);
  EXPECT_EQ(refusal({}, 0, most + 1).find("device memory: buffer \"moments\" takes "), 0u);
  EXPECT_EQ(refusal({}, 0, 0, most + 1).find("device memory: buffer \"errors\" takes "), 0u);
  EXPECT_EQ(refusal({{"normals", nullptr, most + 1}}, 0, 0).find("device memory: buffer \"normals\" takes "), 0u);
}

TEST(upload_test, all_buffers_together_have_the_devices_memory) {
  const std::size_t most = largest_buffer();
  const std::vector<BufferPlan> plan(all_memory() / most + 1, {"nodes", nullptr, most});
  EXPECT_EQ(refusal(plan, 0, 0).find("device memory: the scene with its film takes "), 0u);
}

TEST(upload_test, what_lies_in_the_hosts_memory_is_refused_if_it_exceeds_that_and_files_do_not_count) {
  const std::size_t too_much = std::size_t{1} << 60;
  const std::string message = "memory: the scene, the film and its layers take 1099511627776 MiB, expected at most the ";
  EXPECT_EQ(refusal({}, 0, 0, 0, too_much).find(message), 0u);
  EXPECT_EQ(refusal({}, 0, 0, 0, too_much, 0, std::make_shared<const std::filesystem::path>(".")), "");
  EXPECT_EQ(refusal({}, 0, 0, 0, 0, too_much).find(message), 0u);
  EXPECT_EQ(refusal({}, 1 << 20, 0, 0, 1 << 20, 1 << 20), "");
}

// A film of 2^20 pixels and 184 MiB, on a device that shares the host's memory: twice there, or once and a quarter of the limit, or in a
// file. On another device, once or in a file.
TEST(upload_test, a_film_lies_in_files_if_the_limit_does_not_hold_it_with_its_share_of_the_device) {
  Scene scene;
  scene.settings.crop_width = scene.settings.crop_height = 1024;
  constexpr std::size_t MIB = 1 << 20;
  const bool shared = device().device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>();
  const auto planned = [&](std::size_t limit, std::size_t error_bytes = 0) {
    FilmLimits limits;
    limits.in_memory = limit;
    limits.error_bytes = error_bytes;
    return plan_film(device(), scene, {}, limits);
  };
  EXPECT_EQ(planned(368 * MIB).bands, 1u);
  EXPECT_FALSE(planned(368 * MIB).directory);
  EXPECT_EQ(planned(368 * MIB - 1).bands, shared ? 3u : 1u);  // of 92 MiB, 512 rows would be, and so of 504
  EXPECT_EQ(planned(368 * MIB, 1).bands, shared ? 2u : 1u);
  const std::size_t least = shared ? 184 * MIB / 3 * 4 + 4 : 184 * MIB;  // 184 MiB and a quarter of itself
  EXPECT_FALSE(planned(least).directory);
  EXPECT_TRUE(planned(least - 8).directory);
  EXPECT_TRUE(planned(least, 1).directory);
  EXPECT_EQ(planned(least).whole, 184 * MIB);
  EXPECT_EQ(planned(least, 1).whole, 185 * MIB);
  EXPECT_LE(planned(64 * MIB).band(), shared ? 16 * MIB : 184 * MIB);
}

// 184 bytes a pixel, 328 with moments: 100 x 1000 pixels.
TEST(upload_test, a_film_has_as_few_bands_of_whole_tile_rows_as_fit) {
  Scene scene;
  scene.settings.crop_width = 100;
  scene.settings.crop_height = 1000;
  const auto planned = [&](std::size_t most) { return plan_film(device(), scene, {}, {.on_device = most, .in_memory = std::size_t{1} << 40}); };
  EXPECT_EQ(planned(18400000).bands, 1u);
  EXPECT_EQ(planned(18400000).rows, 1000u);
  EXPECT_EQ(planned(18399999).rows, 992u);
  EXPECT_EQ(planned(18399999).bands, 2u);
  EXPECT_EQ(planned(18400 * 333).rows, 328u);
  EXPECT_EQ(planned(18400 * 333).bands, 4u);
  scene.settings.crop_height = 1001;
  EXPECT_EQ(planned(18400 * 1001).bands, 1u);
  scene.settings.crop_height = 1000;
  EXPECT_EQ(planned(1).rows, 8u);  // a row of tiles, whatever it takes
  EXPECT_EQ(planned(18400 * 333).film, 328u * 100 * 64);
  EXPECT_EQ(planned(18400 * 333).errors, 328u * 100 * 120);
  EXPECT_EQ(planned(18400 * 333).moments, 0u);
  scene.features = FEATURE_MOMENTS;
  EXPECT_EQ(planned(32800 * 333).rows, 328u);
  EXPECT_EQ(planned(32800 * 333).moments, 328u * 100 * 144);
}

// What this device allows beside a scene that leaves it little.
TEST(upload_test, the_scene_goes_before_the_film) {
  Scene scene;
  scene.settings.crop_width = 100;
  scene.settings.crop_height = 1000;
  const std::vector<BufferPlan> plan = {{"nodes", nullptr, all_memory() - all_memory() / 16 - 18400 * 20}};
  EXPECT_EQ(plan_film(device(), scene, plan).rows, 16u);
}

// 46 GiB of film, in whatever bands this device takes; the largest film that random streams can number has items that 32 bits can.
TEST(upload_test, a_film_of_16384_squared_is_planned_within_the_devices_limits) {
  Scene scene;
  scene.settings.crop_width = scene.settings.crop_height = 16384;
  const FilmPlan plan = plan_film(device(), scene, {});
  EXPECT_GE(std::uint64_t{plan.rows} * plan.bands, 16384u);
  EXPECT_LE(plan.film, largest_buffer());
  EXPECT_LE(plan.errors, largest_buffer());
  EXPECT_LE(plan.film + plan.errors, all_memory());
  EXPECT_EQ(plan_film(device(), scene, {}, {.on_device = 1 << 30, .in_memory = std::size_t{1} << 40}).rows, 352u);  // 2^30 / (184 * 16384) = 356.2
  scene.settings.crop_width = 65536;
  scene.settings.crop_height = 32768;
  EXPECT_LE(padded_pixels(scene.settings), std::size_t{1} << 31);
  record_law("X46");
}
