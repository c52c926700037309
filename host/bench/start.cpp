// From the start of the process to its first sample, without the time that loading the scene takes.
#include <stdlib.h>

#include <functional>

#include "../render.h"
#include "bench.h"
#include "child.h"
#include "machine.h"
#include "subjects.h"
#include "temporary_directory.h"

namespace oclair::bench {
namespace {

// Processor time beside wall time: on a machine that does other things too it says what the second would be.
struct Times {
  double wall, cpu;
};

// In a process of its own.
Times times_in_child(const std::function<void()>& run) {
  double cpu = 0.0;
  const double wall = seconds_of([&] { cpu = std::stod(in_child([&] { return std::to_string(timed_on_cpu(run)()); })); });
  return {wall, cpu};
}

// Reading, placing, and the BVH.
Times load(const Options& options, const std::filesystem::path& file) {
  return times_in_child([&] { build_bvh(place_scene(read_scene(file, options.definitions)), 8); });
}

// A kernel with everything in it, to the end of the first sample; nothing compiled before.
Times start_with_all_features(const Options& options, const std::filesystem::path& file) {
  const TemporaryDirectory cache;
  return times_in_child([&] {
    setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
    const Device device = open_device(options.device);
    Scene scene = place_scene(read_scene(file, options.definitions));
    scene.features = ALL_FEATURES;
    const Bvh bvh = build_bvh(scene, device.bvh_width);
    Renderer renderer = start_render(device, scene, bvh);
    render_pass(renderer, 1);
  });
}

Times start(const std::vector<std::string>& arguments, const std::filesystem::path& cache) {
  const ProgramRun run = run_program(arguments, cache);
  return {run.seconds, run.cpu_seconds};
}

// No crop window: the size of the film can be chosen.
bool has_whole_film(const Options& options, const std::filesystem::path& file) {
  const WorldFilm film = read_scene(file, options.definitions).film;
  return film.crop_width == film.width && film.crop_height == film.height;
}

// Round by round.
struct Starts {
  std::vector<double> wall, cpu;

  void add(const Times& times, const Times& loading) {
    wall.push_back(times.wall - loading.wall);
    cpu.push_back(times.cpu - loading.cpu);
  }
  void report(const std::string& name, Table& table) const {
    table.add({name, "s", spread_of(wall).median, {}, {}});
    table.add({name + ", processor time", "s", spread_of(cpu).median, {}, {}});
  }
};

}  // namespace

void bench_start(const Options& options, Table& table) {
  const auto file = options.scene ? options.scene : own_scene("cornell");
  if (!file) {
    table.note("start: left out; a SCENE is needed where the source tree of oclair is not at hand");
    return;
  }
  table.heading("start to first sample, without the loading of " + file->filename().string() + ", all cores, load " +
                load_average());
  const TemporaryDirectory directory;
  std::vector<std::string> arguments = {"render", std::filesystem::absolute(*file).string(), "--spp", "1",
                                        "-o",     (directory.path() / "image.exr").string()};
  if (has_whole_film(options, *file)) arguments.insert(arguments.end(), {"--size", "64x64"});
  if (!options.device.empty()) arguments.insert(arguments.end(), {"--device", options.device});
  for (const auto& [name, value] : options.definitions) arguments.insert(arguments.end(), {"-D", name + "=" + value});

  const TemporaryDirectory warm_cache;
  Starts warm, cold, everything, loads;
  run_program(arguments, warm_cache.path());
  for (unsigned round = 0; round < options.rounds; ++round) {
    const Times loading = load(options, *file);
    loads.add(loading, {});
    warm.add(start(arguments, warm_cache.path()), loading);
    if (round >= 3) continue;  // these take seconds, of which loading is little
    const TemporaryDirectory cold_cache;
    cold.add(start(arguments, cold_cache.path()), loading);
    everything.add(start_with_all_features(options, *file), loading);
  }
  warm.report("start, kernels compiled before", table);
  cold.report("start, first time on this machine", table);
  everything.report("start, first time, kernel with all features", table);
  loads.report("loading of the scene, not counted above", table);
}

}  // namespace oclair::bench
