#include "loading.h"

#include <cstdio>

namespace oclair {

World load_world(const std::filesystem::path& file, const Definitions& definitions, std::ostream& log) {
  World world = read_scene(file, definitions);
  for (const std::string& warning : world.warnings) log << "oclair: warning: " << warning << "\n";
  return world;
}

std::string format_bytes(std::size_t bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 1024.0 && unit < 3; ++unit) value /= 1024.0;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

}  // namespace oclair
