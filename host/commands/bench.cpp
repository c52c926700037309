#include "../bench/bench.h"

#include <iostream>
#include <memory>

#include "../bench/child.h"
#include "../bench/embree_peer.h"
#include "../bench/machine.h"
#include "../bench/terrain.h"
#include "../device.h"
#include "options.h"

namespace oclair {
namespace {

struct BenchOptions {
  std::string part = "all";
  bench::Options measurement;
  std::optional<std::filesystem::path> json;
  bool growth = false;
};

constexpr const char* parts[] = {"traversal", "path", "build", "start", "sampler", "all"};

void check_part(const std::string& part) {
  for (const char* known : parts)
    if (part == known) return;
  throw Error(Exit::usage, "PART '" + part + "': expected traversal, path, build, start, sampler or all");
}

Exit run(const BenchOptions& options) {
  bench::Table table(std::cout);
  table.setting("machine", bench::cpu_model());
  table.setting("load", bench::load_average());
  table.setting("program", "oclair " OCLAIR_VERSION);
  table.setting("device", bench::in_child([&] { return describe(open_device(options.measurement.device).device); }));
  table.setting("Embree", bench::in_child(bench::embree_description));
  table.setting("rounds", std::to_string(options.measurement.rounds));
  if (options.json) table.write_json(*options.json);  // a name that cannot be written fails now, not after the measurements
  const bool all = options.part == "all",
             growth = options.growth || (all && !options.measurement.scene && !options.measurement.triangles);
  // After each part, and before the first: a file that cannot be written is not found out only after ten minutes.
  const auto save = [&] {
    if (options.json) table.write_json(*options.json);
  };
  save();
  const auto run_part = [&](const char* part, void (*measure)(const bench::Options&, bench::Table&)) {
    if (options.part != part && !all) return;
    table.take(bench::in_child([&] {
      bench::Table rows(std::cout);
      measure(options.measurement, rows);
      return rows.json();
    }));
    save();
  };
  if (!options.growth) run_part("traversal", bench::bench_traversal);
  if (growth) run_part("traversal", bench::bench_growth);
  run_part("path", bench::bench_path);
  run_part("build", bench::bench_build);
  run_part("start", bench::bench_start);
  run_part("sampler", bench::bench_sampler);
  if (all && !options.measurement.scene && !options.measurement.triangles) table.print_targets();
  return Exit::success;
}

}  // namespace

Command bench_command(CLI::App& program) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App& line = *program.add_subcommand("bench", "Measures speed, beside Embree where it can be compared");
  line.add_option("PART", options->part, "traversal, path, build, start, sampler or all (default)");
  add_scene(line, options->measurement.scene, options->measurement.definitions);
  line.add_option_function<std::string>(
          "--triangles",
          [options](const std::string& given) {
            options->measurement.triangles = whole_number("--triangles", given, bench::least_triangles, 100'000'000);
          },
          "size of the generated mesh, in place of a scene")
      ->type_name("N");
  line.add_option_function<std::string>(
          "--rounds",
          [options](const std::string& given) {
            options->measurement.rounds = static_cast<unsigned>(whole_number("--rounds", given, 1, 1000));
          },
          "repetitions, of which the median is taken; default: 7")
      ->type_name("N");
  line.add_option("--json", options->json, "write the figures to a file, too")->type_name("FILE");
  line.add_flag("--growth", options->growth, "traversal: only the cost of a ray from 10 thousand to 10 million triangles");
  add_device(line, options->measurement.device);
  return {&line, [options] {
            check_part(options->part);
            if (options->measurement.scene && options->measurement.triangles)
              throw Error(Exit::usage, "--triangles: expected no SCENE beside it");
            if (options->growth && (options->measurement.scene || options->measurement.triangles))
              throw Error(Exit::usage, "--growth: expected neither SCENE nor --triangles beside it");
            return run(*options);
          }};
}

}  // namespace oclair
