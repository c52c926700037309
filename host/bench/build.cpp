// Building the BVH against rtcCommitScene, and what triangles cost in memory.
#include <memory>

#include "../bvh.h"
#include "../upload.h"
#include "bench.h"
#include "child.h"
#include "embree_peer.h"
#include "machine.h"
#include "subjects.h"
#include "temporary_directory.h"
#include "terrain.h"
#include "terrain_file.h"

namespace oclair::bench {
namespace {

// Both use as many threads as there are cores that this process may use.
void compare(const Options& options, const Subject& subject, bool one_core, Table& table) {
  if (one_core) use_one_core();
  const Scene scene = subject.make();
  const int width = 8;
  std::unique_ptr<EmbreePeer> peer;
  const auto timed_here = one_core ? timed_on_cpu : timed;
  const std::vector<Seconds> seconds =
      measure({{{}, timed_here([&] { build_bvh(scene, width); })},
               {[&] { peer = std::make_unique<EmbreePeer>(scene, false, ""); }, timed_here([&] { peer->commit(); })}},
              options.rounds);
  table.add({subject.name + " build, " + (one_core ? "one core" : "all cores") + ": rtcCommitScene", "s",
             spread_of(seconds[0]).median, spread_of(seconds[1]).median, ratio_of(seconds[1], seconds[0])});
  if (one_core || scene.triangles.empty()) return;
  table.add(
      {subject.name + " device memory per triangle", "bytes", bytes_per_triangle(scene, build_bvh(scene, width)), {}, {}});
}

void measure_large_render(Table& table) {
  constexpr std::size_t triangles = 10'000'000;
  const TemporaryDirectory directory;
  in_child([&] {
    write_terrain_scene(terrain(triangles), directory.path(), 1024);
    return std::string();
  });
  const ProgramRun run = run_program({"render", (directory.path() / "terrain.xml").string(), "--spp", "1", "-o",
                                      (directory.path() / "terrain.exr").string()},
                                     {});
  table.add({"10M at 1024x1024, process memory", "GiB", run.peak_bytes / (1024.0 * 1024.0 * 1024.0), {}, {}});
  table.add({"10M at 1024x1024, start to end", "s", run.seconds, {}, {}});
}

}  // namespace

void bench_build(const Options& options, Table& table) {
  table.heading("building the BVH, quality medium, width 8, load " + load_average());
  for (const Subject& subject : build_subjects(options))
    for (const bool one_core : {true, false})
      table.take(in_child([&] {
        Table rows = table.empty_copy();
        compare(options, subject, one_core, rows);
        return rows.json();
      }));
  if (!options.scene && !options.triangles) measure_large_render(table);
}

}  // namespace oclair::bench
