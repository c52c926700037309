// The whole path tracer: against the bare traversal of the very rays that it traces, on all cores against one, and the
// kernel that is specialised to the scene against the one with everything in it.
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "../error.h"
#include "../render.h"
#include "bench.h"
#include "child.h"
#include "machine.h"
#include "our_traversal.h"
#include "recorded_rays.h"
#include "subjects.h"
#include "temporary_directory.h"

namespace oclair::bench {
namespace {

enum Action : unsigned char { render_special, render_full, trace_rays, count_closest, count_any, action_count };

// Everything but second moments, which only write more of the film, unless the scene has them.
Features all_features(const Scene& scene) { return (ALL_FEATURES & ~FEATURE_MOMENTS) | scene.features; }

struct Measured {
  Device device;
  Scene scene, everything;  // the latter: for a kernel with all features
  Bvh bvh;
  std::unique_ptr<Renderer> special, full;
  std::unique_ptr<OurTraversal> closest, any;
  RecordedRays rays;

  Measured(const Options& options, Scene placed) : device(open_device(options.device)), scene(std::move(placed)) {
    bvh = build_bvh(scene, device.bvh_width);
    special = std::make_unique<Renderer>(start_render(device, scene, bvh));
  }

  void prepare_full() {
    everything = scene;
    everything.features = all_features(scene);
    full = std::make_unique<Renderer>(start_render(device, everything, bvh));
  }

  void prepare_rays(unsigned samples) {
    rays = record_rays(device, scene, bvh, 0, samples);
    closest = std::make_unique<OurTraversal>(device, scene, bvh);
    any = std::make_unique<OurTraversal>(device, scene, bvh);
    if (!rays.closest.empty()) closest->load(rays.closest);
    if (!rays.any.empty()) any->load(rays.any);
  }
};

// The same samples every time.
void render_again(Renderer& renderer, unsigned samples) {
  renderer.samples = 0;
  render_pass(renderer, samples);
}

Worker::Actions one_core_actions(const Options& options, const Subject& subject, unsigned samples) {
  use_one_core();
  const auto measured = std::make_shared<Measured>(options, subject.make());
  measured->prepare_full();
  if (!(measured->scene.features & FEATURE_OPACITY)) measured->prepare_rays(samples);
  const auto timed_here = [=](std::function<void()> run) { return timed_on(measured->device, std::move(run)); };
  Worker::Actions actions(action_count);
  actions[render_special] = timed_here([=] { render_again(*measured->special, samples); });
  actions[render_full] = timed_here([=] { render_again(*measured->full, samples); });
  actions[trace_rays] = timed_here([=] {
    if (!measured->rays.closest.empty()) measured->closest->run(false);
    if (!measured->rays.any.empty()) measured->any->run(true);
  });
  actions[count_closest] = [=] { return static_cast<double>(measured->rays.closest.size()); };
  actions[count_any] = [=] { return static_cast<double>(measured->rays.any.size()); };
  return actions;
}

// Seconds from the opened device to the compiled kernel, with nothing compiled before, and what PoCL has compiled until
// then.
struct Compilation {
  double seconds, bytes;
};

double object_bytes(const std::filesystem::path& directory) {
  double bytes = 0.0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    if (entry.is_regular_file() && entry.path().extension() == ".so") bytes += static_cast<double>(entry.file_size());
  return bytes;
}

Compilation compile(const Options& options, const Subject& subject, bool everything) {
  const TemporaryDirectory cache;
  const std::string result = in_child([&] {
    setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
    const Device device = open_device(options.device);
    Scene scene = subject.make();
    if (everything) scene.features = all_features(scene);
    const Bvh bvh = build_bvh(scene, device.bvh_width);
    return std::to_string(timed_on(device, [&] { start_render(device, scene, bvh); })());
  });
  return {std::stod(result), object_bytes(cache.path())};
}

void compare_kernels(const Options& options, const Subject& subject, Worker& one_core, Table& table) {
  std::vector<double> times[2];
  Compilation special{}, full{};
  for (unsigned round = 0; round < std::min(options.rounds, 2u); ++round) {
    special = compile(options, subject, false), full = compile(options, subject, true);
    times[0].push_back(special.seconds), times[1].push_back(full.seconds);
  }
  const std::string name = subject.name + " specialised kernel against full: ";
  table.add({name + "compile", "s", spread_of(times[0]).median, spread_of(times[1]).median, ratio_of(times[1], times[0])});
  table.add({name + "machine code", "KiB", special.bytes / 1024.0, full.bytes / 1024.0,
             Spread{full.bytes / special.bytes, full.bytes / special.bytes, full.bytes / special.bytes}});
  const auto seconds = measure(
      {{{}, [&] { return one_core.run(render_special); }}, {{}, [&] { return one_core.run(render_full); }}}, options.rounds);
  table.add(
      {name + "render", "s", spread_of(seconds[0]).median, spread_of(seconds[1]).median, ratio_of(seconds[1], seconds[0])});
}

void compare_with_traversal(const Options& options, const Subject& subject, double samples, Worker& one_core, Table& table) {
  const double rays = one_core.run(count_closest) + one_core.run(count_any);
  if (rays == 0.0) {
    table.note("  " + subject.name +
               ": has masks, whose shadow rays are more than one traversal each; no share of the traversal");
    return;
  }
  const auto seconds = measure(
      {{{}, [&] { return one_core.run(render_special); }}, {{}, [&] { return one_core.run(trace_rays); }}}, options.rounds);
  const double render = spread_of(seconds[0]).median, trace = spread_of(seconds[1]).median;
  table.add({subject.name + " rays/s, share of the bare traversal", "Mrays/s", rays * 1e-6 / render, rays * 1e-6 / trace,
             ratio_of(seconds[1], seconds[0])});
  table.add({subject.name + " samples/s, one core", "Ms/s", samples * 1e-6 / render, {}, {}});
}

void compare_cores(const Options& options, const Subject& subject, unsigned samples, double pixels, Table& table) {
  const auto prepare = [&](bool one) {
    return [&, one]() -> Worker::Actions {
      if (one) use_one_core();
      const auto measured = std::make_shared<Measured>(options, subject.make());
      const auto render = [=] { render_again(*measured->special, samples); };
      return {timed(render), timed_on_cpu(render)};
    };
  };
  Worker one(prepare(true)), all(prepare(false));
  const auto seconds = measure({{{}, [&] { return all.run(0); }}, {{}, [&] { return one.run(0); }}}, options.rounds);
  const auto rate = [&](const Seconds& s) { return samples * pixels * 1e-6 / spread_of(s).median; };
  const std::string cores = std::to_string(core_count()) + " cores against one";
  table.add(
      {subject.name + " samples/s, " + cores, "Ms/s", rate(seconds[0]), rate(seconds[1]), ratio_of(seconds[1], seconds[0])});
  // What more threads cost each other. On a machine that does nothing else, the ratio above is this one times the cores.
  const auto cpu = measure({{{}, [&] { return all.run(1); }}, {{}, [&] { return one.run(1); }}}, options.rounds);
  table.add({subject.name + " samples per processor second, " + cores, "Ms/s", rate(cpu[0]), rate(cpu[1]),
             ratio_of(cpu[1], cpu[0])});
}

}  // namespace

void bench_path(const Options& options, Table& table) {
  constexpr unsigned samples = 1;
  for (const Subject& subject : path_subjects(options)) {
    const double pixels = std::stod(in_child([&] {
      const Settings settings = subject.make().settings;
      return std::to_string(std::uint64_t{settings.crop_width} * settings.crop_height);
    }));
    table.heading("path tracer, " + subject.name + ": " + std::to_string(static_cast<long>(pixels)) + " pixels, " +
                  std::to_string(samples) + " samples each, load " + load_average());
    {
      Worker one_core([&] { return one_core_actions(options, subject, samples); });
      compare_with_traversal(options, subject, samples * pixels, one_core, table);
      compare_kernels(options, subject, one_core, table);
    }
    compare_cores(options, subject, samples, pixels, table);
  }
}

}  // namespace oclair::bench
