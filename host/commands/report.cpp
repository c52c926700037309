#include "report.h"

#include <cstdio>
#include <iomanip>
#include <iostream>

namespace oclair {

void print_warnings(const World& world, std::ostream& log) {
  for (const std::string& warning : world.warnings) log << "oclair: warning: " << warning << "\n";
}

std::ostream& row(const std::string& name) { return std::cout << std::left << std::setw(19) << name << ' '; }

std::string format_bytes(std::size_t bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 1024.0 && unit < 3; ++unit) value /= 1024.0;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

std::string film_text(const FilmPlan& film) {
  std::string text = format_bytes(film.whole) + (film.directory ? " in files beside the checkpoint, " : " in memory, ");
  text += film.bands == 1 ? "all of it" : std::to_string(film.bands) + " bands of " + std::to_string(film.rows) + " rows, one at a time,";
  text += " on the device";
  if (film.layers > 0) text += "; layers: " + format_bytes(film.layers) + " in memory";
  return text;
}

}  // namespace oclair
