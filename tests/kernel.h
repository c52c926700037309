// Runs device code on arrays: every device test is a pair X_test.cl, a kernel that applies the function under test to its
// arguments, and X_test.cpp, which feeds and judges it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "../cl/features.h"
#include "../cl/types.h"
#include "../host/device.h"

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

// An array that the kernel writes; its size is fixed by the caller beforehand.
template <class T, class Allocator>
struct Out {
  std::vector<T, Allocator>& values;
};
template <class T, class Allocator>
Out<T, Allocator> out(std::vector<T, Allocator>& values) {
  return {values};
}

// A program of this directory, built once per process for each set of options.
inline cl::Program& program(const std::string& file, const KernelOptions& options) {
  static auto& built = *new std::map<std::string, cl::Program>;
  const std::string key = file + " " + std::to_string(options.features) + " " + std::to_string(options.bvh_width) + " " +
                          std::to_string(options.stack_size) + " " + std::to_string(options.approximations);
  const auto found = built.find(key);
  if (found != built.end()) return found->second;
  return built.emplace(key, build_program(device(), directory() / file, options)).first->second;
}

namespace detail {
template <class T>
struct Buffered : std::false_type {};
template <class T, class Allocator>
struct Buffered<std::vector<T, Allocator>> : std::true_type {};
template <class T, class Allocator>
struct Buffered<Out<T, Allocator>> : std::true_type {};

template <class T, class Allocator>
const std::vector<T, Allocator>& content(const std::vector<T, Allocator>& values) {
  return values;
}
template <class T, class Allocator>
std::vector<T, Allocator>& content(const Out<T, Allocator>& values) {
  return values.values;
}

template <class Argument>
void bind(cl::Kernel& kernel, cl_uint index, std::vector<cl::Buffer>& buffers, const Argument& argument) {
  if constexpr (Buffered<Argument>::value) {
    const auto& values = content(argument);
    const std::size_t bytes = values.size() * sizeof(values[0]);
    buffers.emplace_back(device().context, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 16));
    if (bytes > 0) device().queue.enqueueWriteBuffer(buffers.back(), CL_TRUE, 0, bytes, values.data());
    kernel.setArg(index, buffers.back());
  } else {
    kernel.setArg(index, argument);
  }
}

template <class T, class Allocator>
void fetch(const cl::Buffer*& buffer, const std::vector<T, Allocator>&) {
  ++buffer;
}
template <class T, class Allocator>
void fetch(const cl::Buffer*& buffer, const Out<T, Allocator>& out) {
  if (!out.values.empty())
    device().queue.enqueueReadBuffer(*buffer, CL_TRUE, 0, out.values.size() * sizeof(T), out.values.data());
  ++buffer;
}
template <class Scalar>
  requires(!Buffered<Scalar>::value)
void fetch(const cl::Buffer*&, const Scalar&) {}
}  // namespace detail

// Runs `count` work items of the kernel. Arguments in the kernel's order: std::vector is read, out(vector) is read and written
// back, anything else is passed by value. The number of work items is padded to whole groups: kernels take `count` as their first
// argument and return beyond it.
template <class... Arguments>
void run_with(const KernelOptions& options, const std::string& file, const std::string& name, std::size_t count,
              const Arguments&... arguments) {
  cl::Kernel kernel(program(file, options), name.c_str());
  std::vector<cl::Buffer> buffers;
  kernel.setArg(0, static_cast<cl_uint>(count));
  cl_uint index = 1;
  (detail::bind(kernel, index++, buffers, arguments), ...);
  const std::size_t groups = (count + WORK_GROUP_SIZE - 1) / WORK_GROUP_SIZE;
  device().queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * WORK_GROUP_SIZE), cl::NDRange(WORK_GROUP_SIZE));
  device().queue.finish();
  const cl::Buffer* buffer = buffers.data();
  (detail::fetch(buffer, arguments), ...);
}

template <class... Arguments>
void run(const std::string& file, const std::string& name, std::size_t count, const Arguments&... arguments) {
  run_with({every_feature}, file, name, count, arguments...);
}

}  // namespace oclair::test
