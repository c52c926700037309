// Runs device code on arrays: every device test is a pair X_test.cl, a kernel that applies the function under test to its
// arguments, and X_test.cpp, which feeds and judges it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "../cl/features.h"
#include "../cl/types.h"
#include "../host/device.h"
#include "../host/selftest/launch.h"

namespace oclair::test {

inline constexpr Features every_feature = ALL_FEATURES;

// Under a memory checker (OCLAIR_SMALL=1) inputs shrink to what it can run in a minute.
inline bool small_inputs() { return std::getenv("OCLAIR_SMALL") != nullptr; }
inline std::size_t count_or_small(std::size_t count, std::size_t small) { return small_inputs() ? small : count; }

// Neither this nor the programs are ever released: after main a driver may have torn down what its release functions touch
// (oclgrind keeps their names on a thread's stack of its own, and writes to it when it is freed).
inline const Device& device() {
  static const Device& opened = *new Device(open_device());
  return opened;
}

// ctest runs the tests of device code once more with denormals flushed (tests/CMakeLists.txt).
inline bool keeps_denormals() {
  const char* flags = std::getenv("POCL_EXTRA_BUILD_FLAGS");
  if (flags && std::string(flags).find("-cl-denorms-are-zero") != std::string::npos) return false;
  return (device().device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_DENORM) != 0;
}

inline std::filesystem::path directory() { return OCLAIR_TEST_DIRECTORY; }

// A program of this directory, built once per process for each set of options.
inline cl::Program& program(const std::string& file, const KernelOptions& options) {
  static auto& built = *new std::map<std::string, cl::Program>;
  const std::string key = file + " " + std::to_string(options.features) + " " + std::to_string(options.bvh_width) + " " +
                          std::to_string(options.stack_size) + " " + std::to_string(options.approximations) +
                          (options.double_precision ? " double" : "");
  const auto found = built.find(key);
  if (found != built.end()) return found->second;
  return built.emplace(key, build_program(device(), directory() / file, options)).first->second;
}

// Runs `count` work items of a kernel, see launch().
template <class... Arguments>
void run_with(const KernelOptions& options, const std::string& file, const std::string& name, std::size_t count,
              const Arguments&... arguments) {
  launch(device(), program(file, options), name.c_str(), count, arguments...);
}

template <class... Arguments>
void run(const std::string& file, const std::string& name, std::size_t count, const Arguments&... arguments) {
  run_with({every_feature}, file, name, count, arguments...);
}

}  // namespace oclair::test
