#include "device.h"

#include <algorithm>
#include <cctype>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>


namespace oclair {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// Drivers pad names with blanks and NULs.
std::string trimmed(std::string text) {
  const auto visible = [](unsigned char c) { return std::isgraph(c) != 0; };
  text.erase(std::find_if(text.rbegin(), text.rend(), visible).base(), text.end());
  text.erase(text.begin(), std::find_if(text.begin(), text.end(), visible));
  return text;
}

std::string platform_name(const cl::Device& device) {
  return trimmed(cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>());
}

bool is_cpu(const cl::Device& device) { return (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0; }

std::size_t select(const std::vector<cl::Device>& devices, const std::string& selector) {
  if (selector.empty()) {
    const auto embedded = std::find_if(devices.begin(), devices.end(), [](const cl::Device& device) {
      return is_cpu(device) && platform_name(device) == "Portable Computing Language";
    });
    return embedded == devices.end() ? 0 : static_cast<std::size_t>(embedded - devices.begin());
  }
  if (std::all_of(selector.begin(), selector.end(), [](unsigned char c) { return std::isdigit(c); })) {
    if (selector.size() < 9 && std::stoul(selector) < devices.size()) return std::stoul(selector);
  } else {
    for (std::size_t i = 0; i < devices.size(); ++i)
      if (lower(describe(devices[i])).find(lower(selector)) != std::string::npos) return i;
  }
  throw Error(Exit::device, "device \"" + selector + "\" does not exist: expected an index below " +
                                std::to_string(devices.size()) + " or a part of a name that `oclair devices` prints");
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw Error(Exit::device, file.string() + ": cannot be read; expected a kernel source of oclair");
  return text.str();
}

// FNV-1a (Fowler, Noll, Vo): names a compilation; nothing depends on its strength.
std::uint64_t hash(const std::string& text, std::uint64_t h = 0xcbf29ce484222325u) {
  for (unsigned char c : text) h = (h ^ c) * 0x100000001b3u;
  return h;
}

std::uint64_t hash_of_headers(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    if (entry.path().extension() == ".h") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::uint64_t h = hash("");
  for (const auto& file : files) h = hash(read_text(file), h);
  return h;
}

}  // namespace

std::vector<cl::Device> list_devices() {
  std::vector<cl::Device> devices;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {  // the loader's way to say that there is no platform
    return devices;
  }
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> found;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &found);
    } catch (const cl::Error&) {  // likewise: a platform without devices
      continue;
    }
    devices.insert(devices.end(), found.begin(), found.end());
  }
  return devices;
}

std::string describe(const cl::Device& device) {
  std::ostringstream line;
  line << trimmed(device.getInfo<CL_DEVICE_NAME>()) << " (" << platform_name(device) << ", "
       << trimmed(device.getInfo<CL_DEVICE_VERSION>()) << ", driver " << trimmed(device.getInfo<CL_DRIVER_VERSION>()) << ", "
       << (is_cpu(device) ? "CPU" : "GPU or accelerator") << ", " << device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()
       << " compute units, " << (device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>() >> 20) << " MiB)";
  return line.str();
}

Device open_device(const std::string& selector) {
  const std::vector<cl::Device> devices = list_devices();
  if (devices.empty())
    throw Error(Exit::device,
                "no OpenCL device found: expected an OpenCL driver, for example the package pocl-opencl-icd, and for PoCL a "
                "writable POCL_CACHE_DIR, ~/.cache by default");
  const cl::Device device = devices[select(devices, selector)];
  try {
    cl::Context context(device);
    return {device,
            context,
            cl::CommandQueue(context, device),
            trimmed(device.getInfo<CL_DEVICE_NAME>()),
            platform_name(device) + ", " + trimmed(device.getInfo<CL_DEVICE_VERSION>()),
            is_cpu(device) ? 8 : 4,
            kernel_directory(),
            {}};
  } catch (const cl::Error& error) {
    throw Error(Exit::device, describe(device) + ": cannot be opened: " + error.what() + " returned " +
                                  std::to_string(error.err()) + "; expected a working OpenCL driver");
  }
}

Error device_error(const Device& device, const cl::Error& error) {
  return Error(Exit::device, device.name + ": " + error.what() + " returned " + std::to_string(error.err()));
}

void require_double_precision(const Device& device) {
  if (device.device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() == 0)
    throw Error(Exit::device,
                device.name + ": has no double precision, expected a device with cl_khr_fp64 for --arithmetic double");
}

std::string kernel_hash() {
  const std::filesystem::path directory = kernel_directory();
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016" PRIx64, hash(read_text(directory / "path.cl"), hash_of_headers(directory)));
  return digits;
}

std::filesystem::path kernel_directory() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/oclair/cl";
  return std::filesystem::is_directory(installed, ignored) ? installed : std::filesystem::path(OCLAIR_KERNEL_DIRECTORY);
}

cl::Program build_program(const Device& device, const std::filesystem::path& source, const KernelOptions& options) {
  std::ostringstream flags;
  flags << "-cl-std=CL1.2 -DFEATURES=" << options.features << "ul -DAPPROXIMATIONS=" << options.approximations << "ul -DBVH_WIDTH=" << options.bvh_width
        << " -DSTACK_SIZE=" << options.stack_size;
  if (options.double_precision) flags << " -DDOUBLE_PRECISION=1";
  if (device.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)
    flags << " -cl-fp32-correctly-rounded-divide-sqrt";
  if (!device.flags.empty()) flags << " " << device.flags;

  // Versions of PoCL return a stale cached kernel when only an option or an included file changed (its issue 608), so the
  // text itself says what it is compiled with and from. Included files find each other beside themselves: with no -I, a blank
  // in the path, which no option can hold, does no harm.
  std::ostringstream text;
  text << "// " << std::hex << hash(flags.str() + read_text(source), hash_of_headers(device.kernels)) << "\n#include \""
       << std::filesystem::absolute(source).string() << "\"\n";
  try {
    cl::Program program(device.context, text.str());
    try {
      program.build({device.device}, flags.str().c_str());
    } catch (const cl::Error&) {
      throw Error(Exit::device, source.string() + ": does not compile on " + device.name + ":\n" +
                                    program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device));
    }
    return program;
  } catch (const cl::Error& error) {
    throw Error(Exit::device, source.string() + ": cannot be built on " + device.name + ": " + error.what() + " returned " +
                                  std::to_string(error.err()));
  }
}

}  // namespace oclair
