#include "../selftest/selftest.h"

#include <fstream>
#include <iostream>
#include <memory>

#include "options.h"

namespace oclair {
namespace {

struct SelftestOptions {
  std::string device;
  std::optional<std::string> json;  // a file, or - for standard output
};

void write_json(const std::string& file, const std::string& json) {
  std::ofstream stream(file);
  stream << json;
  if (!stream.flush())
    throw Error(Exit::render_failed, file + ": cannot be written, expected a file in a writable directory");
}

std::string verdict(const selftest::Report& report) {
  std::string failed;
  for (const selftest::Group& group : report.groups)
    if (!group.passed()) failed += (failed.empty() ? "failed: " : ", ") + group.name;
  return failed.empty() ? "all " + std::to_string(report.groups.size()) + " groups passed" : failed;
}

Exit run(const SelftestOptions& options) {
  const bool json_only = options.json == "-", json_file = options.json && !json_only;
  std::ostream& lines = json_only ? std::cerr : std::cout;
  const Device device = open_device(options.device);
  if (json_file) write_json(*options.json, "");  // one that cannot be written fails now
  std::cerr << "compiling the self-test for " << device.name << " ..." << std::endl;
  lines << describe(device.device) << std::endl;
  const selftest::Report report =
      selftest::run_selftest(device, [&](const selftest::Group& group) { lines << line_of(group) << std::endl; });
  if (json_only) std::cout << report.json() << "\n";
  if (json_file) write_json(*options.json, report.json() + "\n");
  lines << verdict(report) << ", in " << static_cast<int>(report.seconds + 0.5) << " s" << std::endl;
  return report.passed() ? Exit::success : Exit::check_failed;
}

}  // namespace

Command selftest_command(CLI::App& program) {
  const auto options = std::make_shared<SelftestOptions>();
  CLI::App& line = *program.add_subcommand("selftest", "Tests whether a device computes what the renderer rests on");
  line.add_option("--json", options->json, "write the results to a file, too, or with - to standard output alone")
      ->type_name("FILE");
  add_device(line, options->device);
  return {&line, [options] { return run(*options); }};
}

}  // namespace oclair
