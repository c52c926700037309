#include "subjects.h"

#include <cstdio>

#include "../device.h"
#include "../error.h"
#include "scan.h"
#include "terrain.h"

namespace oclair::bench {
namespace {

Scene read(const Options& options, const std::filesystem::path& file) {
  return place_scene(read_scene(file, options.scene ? options.definitions : Definitions{}));
}

// Only what Embree is given too: the triangles, in the canonical frame.
Scene triangles_of(Scene scene) {
  scene.quadrics.clear();
  scene.features = FEATURE_TRIANGLES;
  return scene;
}

Subject generated(std::size_t n) {
  return {short_count(n), [n] { return place_scene(world_of(terrain(n))); }};
}

}  // namespace

std::string short_count(std::size_t count) {
  char text[32];
  if (count >= 999500)
    std::snprintf(text, sizeof text, "%.3gM", static_cast<double>(count) * 1e-6);
  else if (count >= 1000)
    std::snprintf(text, sizeof text, "%.3gk", static_cast<double>(count) * 1e-3);
  else
    std::snprintf(text, sizeof text, "%zu", count);
  return text;
}

std::optional<std::filesystem::path> own_scene(const std::string& name) {
  const std::filesystem::path file = kernel_directory().parent_path() / "scenes" / (name + ".xml");
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  return file;
}

std::vector<Subject> traversal_subjects(const Options& options, Table& table) {
  std::vector<Subject> subjects;
  if (options.scene) {
    subjects.push_back({options.scene->stem().string(), [&options] {
                          Scene scene = triangles_of(read(options, *options.scene));
                          if (scene.triangles.empty())
                            throw Error(Exit::scene,
                                        options.scene->string() + ": has no triangles; expected some to trace rays through");
                          return scene;
                        }});
    return subjects;
  }
  const auto add = [&](const std::string& name, std::function<Mesh()> mesh) {
    subjects.push_back({name, [mesh] { return triangles_of(place_scene(world_of(mesh()))); }});
  };
  if (options.triangles) {
    add(short_count(*options.triangles), [n = *options.triangles] { return terrain(n); });
    return subjects;
  }
  add("70k", [] { return terrain(70'000); });
  add("1.3M", [] { return terrain(1'300'000); });
  add("sticks 200k", [] { return sticks(200'000); });
  if (scan_is_there())
    add("bunny", [] { return in_box(scan()); });
  else
    table.note(std::string("bunny: left out, ") + scan_file + " is absent (Debian's package glmark2-data)");
  return subjects;
}

std::vector<Subject> build_subjects(const Options& options) {
  if (options.scene) return path_subjects(options);
  if (options.triangles) return {generated(*options.triangles)};
  return {generated(70'000),
          generated(1'300'000),
          {"1.3M smooth", [] { return place_scene(world_of(smooth(terrain(1'300'000)))); }},
          {"sticks 200k", [] { return place_scene(world_of(sticks(200'000))); }}};
}

std::vector<Subject> path_subjects(const Options& options) {
  if (options.scene) return {{options.scene->stem().string(), [&options] { return read(options, *options.scene); }}};
  if (options.triangles) return {generated(*options.triangles)};
  std::vector<Subject> subjects = {generated(70'000), generated(1'300'000)};
  subjects.push_back({"1000 small lights", [] { return place_scene(world_of(terrain(70'000), small_lamps(1000))); }});
  for (const char* name : {"cornell", "diamond", "mirror-glass", "oren-nayar", "normal-map"})
    if (const auto file = own_scene(name)) subjects.push_back({name, [&options, file] { return read(options, *file); }});
  return subjects;
}

}  // namespace oclair::bench
