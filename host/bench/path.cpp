// The whole path tracer: against the bare traversal of the very rays that it traces, on all cores against one, and the
// kernel that is specialised to the scene against the one with everything in it.
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "../error.h"
#include "../render.h"
#include "../variant.h"
#include "bench.h"
#include "child.h"
#include "machine.h"
#include "our_traversal.h"
#include "recorded_rays.h"
#include "subjects.h"
#include "temporary_directory.h"

namespace oclair::bench {
namespace {

enum Action : unsigned char { render_exact, render_shared, render_full, trace_rays, count_closest, count_any, action_count };

// What a scene's kernel is compiled for.
enum class Kernel { exact, shared, full };

Scene compiled_for(Kernel kernel, Scene scene) {
  scene.exact_kernel = kernel != Kernel::shared;
  if (kernel == Kernel::full) scene.features = variant_features(Variant::FULL, scene.features);
  return scene;
}

struct Measured {
  Device device;
  Scene scene, shared_scene, full_scene;
  Bvh bvh;
  std::unique_ptr<Renderer> exact, shared, full;
  std::unique_ptr<OurTraversal> closest, any;
  RecordedRays rays;

  Measured(const Options& options, Scene placed) : device(open_device(options.device)), scene(compiled_for(Kernel::exact, std::move(placed))) {
    bvh = build_bvh(scene, device.bvh_width);
    exact = std::make_unique<Renderer>(start_render(device, scene, bvh));
  }

  void prepare_others() {
    shared_scene = compiled_for(Kernel::shared, scene), full_scene = compiled_for(Kernel::full, scene);
    shared = std::make_unique<Renderer>(start_render(device, shared_scene, bvh));
    full = std::make_unique<Renderer>(start_render(device, full_scene, bvh));
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
  measured->prepare_others();
  if (!(measured->scene.features & FEATURE_OPACITY)) measured->prepare_rays(samples);
  const auto timed_here = [=](std::function<void()> run) { return timed_on(measured->device, std::move(run)); };
  Worker::Actions actions(action_count);
  actions[render_exact] = timed_here([=] { render_again(*measured->exact, samples); });
  actions[render_shared] = timed_here([=] { render_again(*measured->shared, samples); });
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

Compilation compile(const Options& options, const Subject& subject, Kernel kernel) {
  const TemporaryDirectory cache;
  const std::string result = in_child([&] {
    setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
    const Device device = open_device(options.device);
    const Scene scene = compiled_for(kernel, subject.make());
    const Bvh bvh = build_bvh(scene, device.bvh_width);
    return std::to_string(timed_on(device, [&] { start_render(device, scene, bvh); })());
  });
  return {std::stod(result), object_bytes(cache.path())};
}

void compare_kernels(const Options& options, const Subject& subject, Worker& one_core, Table& table) {
  constexpr Kernel kernels[] = {Kernel::exact, Kernel::shared, Kernel::full};
  Seconds times[3];
  double bytes[3];
  for (unsigned round = 0; round < std::min(options.rounds, 2u); ++round)
    for (int k = 0; k < 3; ++k) {
      const Compilation compilation = compile(options, subject, kernels[k]);
      times[k].push_back(compilation.seconds), bytes[k] = compilation.bytes;
    }
  const auto run = [&](Action action) { return Contender{{}, [&one_core, action] { return one_core.run(action); }}; };
  const auto seconds = measure({run(render_exact), run(render_shared), run(render_full)}, options.rounds);
  for (int k = 1; k < 3; ++k) {
    const std::string name = subject.name + " exact kernel against " + (k == 1 ? "shared: " : "full: ");
    table.add({name + "compile", "s", spread_of(times[0]).median, spread_of(times[k]).median, ratio_of(times[k], times[0])});
    const double ratio = bytes[k] / bytes[0];
    table.add({name + "machine code", "KiB", bytes[0] / 1024.0, bytes[k] / 1024.0, Spread{ratio, ratio, ratio}});
    table.add({name + "render", "s", spread_of(seconds[0]).median, spread_of(seconds[k]).median, ratio_of(seconds[k], seconds[0])});
  }
}

void compare_with_traversal(const Options& options, const Subject& subject, double samples, Worker& one_core, Table& table) {
  const double rays = one_core.run(count_closest) + one_core.run(count_any);
  if (rays == 0.0) {
    table.note("  " + subject.name +
               ": has masks, whose shadow rays are more than one traversal each; no share of the traversal");
    return;
  }
  const auto seconds = measure(
      {{{}, [&] { return one_core.run(render_exact); }}, {{}, [&] { return one_core.run(trace_rays); }}}, options.rounds);
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
      const auto render = [=] { render_again(*measured->exact, samples); };
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
