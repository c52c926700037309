// From the start of the process to its first sample, without the time that loading the scene takes.
#include <stdlib.h>

#include <algorithm>

#include "../render.h"
#include "bench.h"
#include "child.h"
#include "machine.h"
#include "subjects.h"
#include "temporary_directory.h"

namespace oclair::bench {
namespace {

struct Load {
  double seconds;
  bool whole_film;  // no crop window: the size of the film can be chosen
};

// Reading, placing, and the BVH, in a process of its own.
Load load(const Options& options, const std::filesystem::path& file) {
  const std::string result = in_child([&] {
    bool whole_film = false;
    const double seconds = seconds_of([&] {
      const Scene scene = place_scene(read_scene(file, options.definitions));
      build_bvh(scene, 8);
      const Settings& s = scene.settings;
      whole_film = s.crop_width == s.film_width && s.crop_height == s.film_height;
    });
    return std::to_string(seconds) + (whole_film ? " 1" : " 0");
  });
  return {std::stod(result), result.back() == '1'};
}

// A kernel with everything in it, from the fork to the end of the first sample; nothing compiled before.
double seconds_with_all_features(const Options& options, const std::filesystem::path& file) {
  const TemporaryDirectory cache;
  return seconds_of([&] {
    in_child([&] {
      setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
      const Device device = open_device(options.device);
      Scene scene = place_scene(read_scene(file, options.definitions));
      scene.features = ALL_FEATURES;
      const Bvh bvh = build_bvh(scene, device.bvh_width);
      Renderer renderer = start_render(device, scene, bvh);
      render_pass(renderer, 1);
      return std::string();
    });
  });
}

}  // namespace

void bench_start(const Options& options, Table& table) {
  const auto file = options.scene ? options.scene : own_scene("cornell");
  if (!file) {
    table.note("start: left out; a SCENE is needed where the source tree of oclair is not at hand");
    return;
  }
  table.heading("start to first sample, without the loading of " + file->filename().string() + ", all cores, load " + load_average());
  const TemporaryDirectory directory;
  std::vector<std::string> arguments = {"render", std::filesystem::absolute(*file).string(), "--spp", "1",
                                        "-o",     (directory.path() / "image.exr").string()};
  if (load(options, *file).whole_film) arguments.insert(arguments.end(), {"--size", "64x64"});
  if (!options.device.empty()) arguments.insert(arguments.end(), {"--device", options.device});
  for (const auto& [name, value] : options.definitions) arguments.insert(arguments.end(), {"-D", name + "=" + value});

  const TemporaryDirectory warm_cache;
  std::vector<double> warm, cold, everything, loads;
  run_program(arguments, warm_cache.path());
  for (unsigned round = 0; round < options.rounds; ++round) {
    loads.push_back(load(options, *file).seconds);
    warm.push_back(run_program(arguments, warm_cache.path()).seconds - loads.back());
    if (round >= 3) continue;  // these take seconds, of which loading is little
    const TemporaryDirectory cold_cache;
    cold.push_back(run_program(arguments, cold_cache.path()).seconds - loads.back());
    everything.push_back(seconds_with_all_features(options, *file) - loads.back());
  }
  const auto add = [&](const char* name, const std::vector<double>& seconds) {
    table.add({name, "s", spread_of(seconds).median, {}, {}});
  };
  add("start, kernels compiled before", warm);
  add("start, first time on this machine", cold);
  add("start, first time, kernel with all features", everything);
  add("loading of the scene, not counted above", loads);
}

}  // namespace oclair::bench
