// What `oclair selftest` does: asks a device for the arithmetic that the renderer rests on, and judges the answers by
// oracles of the host.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "../device.h"

namespace oclair::selftest {

// Something that was measured, and where there is one the bound that it must not exceed.
struct Figure {
  std::string name;
  std::variant<double, std::string> value;
  std::optional<double> most{};

  bool passed() const;
};

struct Group {
  std::string name;
  std::vector<Figure> figures{};
  std::string error{};   // of a kernel that did not run; empty: all did
  double seconds = 0.0;  // compiling included

  bool passed() const;
  const Figure& figure(const std::string& figure_name) const;  // which there is

  void measure(const std::string& figure_name, double value) { figures.push_back({figure_name, value}); }
  void say(const std::string& figure_name, const std::string& value) { figures.push_back({figure_name, value}); }
  void bound(const std::string& figure_name, double value, double most) { figures.push_back({figure_name, value, most}); }
};

// One line: the name, pass or FAIL, and the figures.
std::string line_of(const Group& group);

struct Report {
  std::string device;
  std::vector<Group> groups{};
  double seconds = 0.0;

  bool passed() const;
  std::string json() const;
};

// Runs every group, or only one, and tells of each when it is done. Throws Error(Exit::device) if the kernels do not
// compile.
Report run_selftest(const Device& device, const std::function<void(const Group&)>& done = {}, const std::string& only = {});

}  // namespace oclair::selftest
