// What is refused before it is allocated.
#include "../host/error.h"
#include "../host/upload.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

std::string refusal(const std::vector<BufferPlan>& plan, std::size_t film, std::size_t moments, std::size_t errors = 0) {
  try {
    check_memory(device(), plan, film, moments, errors);
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
