#include "selftest.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "groups.h"

namespace oclair::selftest {
namespace {

struct Entry {
  const char* name;
  Check* check;
};

// From what everything rests on to what rests on everything.
constexpr Entry entries[] = {
    {"layout", check_layout},       {"contraction", check_contraction}, {"accuracy", check_accuracy},
    {"denormals", check_denormals}, {"exceptions", check_exceptions},   {"integers", check_integers},
    {"film", check_film},           {"sampler", check_sampler},         {"warps", check_warps},
    {"mis", check_mis},             {"fresnel", check_fresnel},         {"textures", check_textures},
    {"boxes", check_boxes},         {"triangles", check_triangles},     {"surfaces", check_surfaces},
    {"render", check_render},
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, value == std::floor(value) && std::abs(value) < 1e9 ? "%.0f" : "%.3g", value);
  return text;
}

std::string text_of(const Figure& figure) {
  if (const auto* words = std::get_if<std::string>(&figure.value)) return figure.name + " " + *words;
  std::string text = figure.name + " " + number_text(std::get<double>(figure.value));
  if (figure.most) text += (figure.passed() ? " (<= " : " (not <= ") + number_text(*figure.most) + ")";
  return text;
}

nlohmann::ordered_json json_of(const Figure& figure) {
  nlohmann::ordered_json entry{{"name", figure.name}};
  if (const auto* words = std::get_if<std::string>(&figure.value))
    entry["value"] = *words;
  else
    entry["value"] = std::get<double>(figure.value);  // null if it is not finite
  if (figure.most) {
    entry["most"] = *figure.most;
    entry["passed"] = figure.passed();
  }
  return entry;
}

}  // namespace

bool Figure::passed() const { return !most || std::get<double>(value) <= *most; }  // NaN has not passed

bool Group::passed() const {
  return error.empty() && std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.passed(); });
}

const Figure& Group::figure(const std::string& figure_name) const {
  return *std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.name == figure_name; });
}

std::string line_of(const Group& group) {
  std::string line = group.name;
  line.resize(13, ' ');
  line += group.passed() ? "pass  " : "FAIL  ";
  for (const Figure& figure : group.figures) line += (&figure == group.figures.data() ? "" : ", ") + text_of(figure);
  if (!group.error.empty()) line += (group.figures.empty() ? "" : "; ") + group.error;
  return line;
}

bool Report::passed() const {
  return std::all_of(groups.begin(), groups.end(), [](const Group& group) { return group.passed(); });
}

std::string Report::json() const {
  nlohmann::ordered_json document{{"program", "oclair " OCLAIR_VERSION},
                                  {"device", device},
                                  {"passed", passed()},
                                  {"seconds", seconds},
                                  {"groups", nlohmann::ordered_json::array()}};
  for (const Group& group : groups) {
    nlohmann::ordered_json entry{{"name", group.name}, {"passed", group.passed()}, {"seconds", group.seconds}};
    if (!group.error.empty()) entry["error"] = group.error;
    entry["figures"] = nlohmann::ordered_json::array();
    for (const Figure& figure : group.figures) entry["figures"].push_back(json_of(figure));
    document["groups"].push_back(std::move(entry));
  }
  return document.dump(2, ' ', false,
                       nlohmann::ordered_json::error_handler_t::replace);  // drivers' names may be in any encoding
}

Report run_selftest(const Device& device, const std::function<void(const Group&)>& done, const std::string& only) {
  const auto start = std::chrono::steady_clock::now();
  Report report{describe(device.device)};
  const Session session{device, build_program(device, device.kernels / "selftest.cl", {ALL_FEATURES, device.bvh_width})};
  for (const Entry& entry : entries) {
    if (!only.empty() && only != entry.name) continue;
    const auto begun = std::chrono::steady_clock::now();
    Group group{entry.name};
    try {
      entry.check(session, group);
    } catch (const cl::Error& error) {
      group.error = one_line(device_error(device, error).what());
    } catch (const Error& error) {
      group.error = one_line(error.what());
    }
    group.seconds = seconds_since(begun);
    if (done) done(group);
    report.groups.push_back(std::move(group));
  }
  report.seconds = seconds_since(start);
  return report;
}

}  // namespace oclair::selftest
