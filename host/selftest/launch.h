// Runs a kernel on arrays.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "../device.h"

namespace oclair::test {

// An array that the kernel writes; its size is fixed by the caller beforehand.
template <class T, class Allocator>
struct Out {
  std::vector<T, Allocator>& values;
};
template <class T, class Allocator>
Out<T, Allocator> out(std::vector<T, Allocator>& values) {
  return {values};
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
void bind(const Device& device, cl::Kernel& kernel, cl_uint index, std::vector<cl::Buffer>& buffers,
          const Argument& argument) {
  if constexpr (Buffered<Argument>::value) {
    const auto& values = content(argument);
    const std::size_t bytes = values.size() * sizeof(values[0]);
    buffers.emplace_back(device.context, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 16));
    if (bytes > 0) device.queue.enqueueWriteBuffer(buffers.back(), CL_TRUE, 0, bytes, values.data());
    kernel.setArg(index, buffers.back());
  } else {
    kernel.setArg(index, argument);
  }
}

template <class T, class Allocator>
void fetch(const Device&, const cl::Buffer*& buffer, const std::vector<T, Allocator>&) {
  ++buffer;
}
template <class T, class Allocator>
void fetch(const Device& device, const cl::Buffer*& buffer, const Out<T, Allocator>& out) {
  if (!out.values.empty())
    device.queue.enqueueReadBuffer(*buffer, CL_TRUE, 0, out.values.size() * sizeof(T), out.values.data());
  ++buffer;
}
template <class Scalar>
requires(!Buffered<Scalar>::value) void fetch(const Device&, const cl::Buffer*&, const Scalar&) {}
}  // namespace detail

// Runs `count` work items of the kernel. Arguments in the kernel's order: std::vector is read, out(vector) is read and
// written back, anything else is passed by value. The number of work items is padded to whole groups: kernels take `count`
// as their first argument and return beyond it.
template <class... Arguments>
void launch(const Device& device, const cl::Program& program, const char* name, std::size_t count,
            const Arguments&... arguments) {
  cl::Kernel kernel(program, name);
  std::vector<cl::Buffer> buffers;
  kernel.setArg(0, static_cast<cl_uint>(count));
  cl_uint index = 1;
  (detail::bind(device, kernel, index++, buffers, arguments), ...);
  const std::size_t groups = (count + WORK_GROUP_SIZE - 1) / WORK_GROUP_SIZE;
  device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * WORK_GROUP_SIZE),
                                    cl::NDRange(WORK_GROUP_SIZE));
  device.queue.finish();
  const cl::Buffer* buffer = buffers.data();
  (detail::fetch(device, buffer, arguments), ...);
}

}  // namespace oclair::test
