// OpenCL devices and programs. OpenCL objects are CL/opencl.hpp's own, which throw cl::Error.
#pragma once

#include <CL/opencl.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "../cl/features.h"
#include "error.h"

namespace oclair {

struct Device {
  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;
  std::string name;      // of the device, as its driver says
  std::string platform;  // and the driver's platform with its version
  int bvh_width;         // children of a BVH node that suit it: 8 on CPUs, 4 elsewhere
  std::filesystem::path kernels;  // directory of the .cl files; kernel_directory() but where a test plants a fault in them
  std::string flags;              // for the compiler beside those of build_program; likewise none but a test's
};

// Every device of every platform, in the order of `oclair devices`: its indices.
std::vector<cl::Device> list_devices();

// One line for people: "NAME (PLATFORM, ...)".
std::string describe(const cl::Device& device);

// The device that `selector` names: an index into list_devices(), or a part of the device's or platform's name in any case.
// Empty: the first CPU device of PoCL, or else the first device. Throws Error(Exit::device) if there is none.
Device open_device(const std::string& selector = {});

// What a program is compiled with. Each distinct value is one compilation.
struct KernelOptions {
  Features features;
  int bvh_width = 8;
  int stack_size = 64;                // entries of the traversal stack
  Approximations approximations = 0;  // that the user asked for
  bool double_precision = false;      // cl/precision.h; the device must have it
};

// Compiles the file (its #includes are relative to it). No flag that relaxes arithmetic is given. Throws Error(Exit::device) with the compiler's first message.
cl::Program build_program(const Device& device, const std::filesystem::path& source, const KernelOptions& options);

// Throws Error(Exit::device) if the device has no arithmetic in double precision.
void require_double_precision(const Device& device);

// "NAME: clFunction returned -5", as Exit::device.
Error device_error(const Device& device, const cl::Error& error);

// Of the source of the kernel that renders: what its samples depend on. 16 hexadecimal digits.
std::string kernel_hash();

// Where the .cl files are: share/oclair/cl beside the installed program, or else the source tree it was built from.
std::filesystem::path kernel_directory();

}  // namespace oclair
