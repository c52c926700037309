// The commands of the program: what each is told, and what it does. A file a command, named like it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "../../cl/features.h"
#include "../aov.h"
#include "../error.h"
#include "../reader.h"
#include "../tev.h"
#include "output.h"

namespace CLI {
class App;
}

namespace oclair {

// What is absent is as the scene says.
struct RenderOptions {
  std::filesystem::path scene;
  Definitions definitions;
  std::string device;                             // name or index as `oclair devices` lists them; empty: the first
  ImageFiles images;
  std::optional<std::uint64_t> samples_per_pixel;
  std::optional<glm::uvec2> size;
  std::optional<std::uint64_t> seed;
  std::optional<unsigned> max_depth;
  std::optional<SamplerKind> sampler;
  Approximations approximations = 0;
  bool exact_kernel = false;
  bool double_precision = false;
  std::size_t device_memory = FilmLimits().on_device, host_memory = FilmLimits().in_memory;  // bytes of film there, at most
  Aovs aovs;

  std::optional<SampleRange> samples;        // those of this part of the render
  std::optional<double> seconds, error;      // limits beside the number of samples
  double confidence = 0.95;                  // with which the error is below its limit
  std::filesystem::path checkpoint;
  bool keep_checkpoint = false;              // also when the render has reached its target
  double checkpoint_every = 30.0;            // seconds
  bool resume = false, restart = false;      // go on with the checkpoint that is there, or drop it
  bool progress_json = false;
  std::optional<HostPort> viewer;            // tev
};

struct InfoOptions {
  std::filesystem::path scene;
  Definitions definitions;
  std::string device;
  std::optional<glm::uvec2> size;
};

Exit render(const RenderOptions& options);
Exit info(const InfoOptions& options);
Exit info_image(const std::filesystem::path& image);  // instead, if the file is one
Exit info_checkpoint(const std::filesystem::path& checkpoint);  // likewise
Exit devices();

// A command as the command line knows it.
struct Command {
  CLI::App* line;             // its part of the command line
  std::function<Exit()> run;  // with the options that were parsed
};

Command render_command(CLI::App& program);
Command merge_command(CLI::App& program);
Command info_command(CLI::App& program);
Command devices_command(CLI::App& program);
Command bench_command(CLI::App& program);
Command selftest_command(CLI::App& program);
Command compare_command(CLI::App& program);

}  // namespace oclair
