#include "../tune/tune.h"

#include <unistd.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <vector>

#include "../file_aside.h"
#include "../schedule.h"
#include "../signals.h"
#include "../tune/report.h"
#include "../tune/table.h"
#include "options.h"
#include "output.h"
#include "report.h"

namespace oclair {
namespace {

struct TuneOptions {
  tune::Request request;
  std::optional<std::string> json;  // a file, or - for standard output
  std::optional<std::filesystem::path> html, settings;
};

// A bar that is drawn anew on a terminal, or a line a setting.
class Bar {
 public:
  void show(std::size_t done, std::size_t of, const std::string& name) const {
    if (!terminal_) {
      std::cerr << "tune  " << (of ? std::to_string(done + 1) + "/" + std::to_string(of) + "  " : "") << name << std::endl;
      return;
    }
    constexpr std::size_t width = 30;
    const std::size_t full = of ? width * done / of : 0;
    std::cerr << "\r\33[K[" << std::string(full, '#') << std::string(width - full, '.') << "] " << done << "/" << of << " " << name
              << std::flush;
  }
  void end() const {
    if (terminal_) std::cerr << "\r\33[K" << std::flush;
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
};

Exit run(const TuneOptions& options) {
  const SignalHandlers handlers;
  const bool json_only = options.json == "-";
  std::vector<std::filesystem::path> outputs;
  if (options.json && !json_only) outputs.emplace_back(*options.json);
  for (const auto& file : {options.html, options.settings})
    if (file) outputs.push_back(*file);
  require_distinct(outputs, {options.request.scene});
  for (const std::filesystem::path& file : outputs) require_writable(file);
  tune::Request request = options.request;
  request.inspect = [&](const World& world) {
    std::vector<std::filesystem::path> inputs;
    for (const SceneFile& file : world.files) inputs.emplace_back(file.path);
    require_distinct(outputs, inputs);
    print_warnings(world, std::cerr);
  };
  const Bar bar;
  const tune::Result result = tune::tune(request, [&](std::size_t done, std::size_t of, const std::string& name) {
    handlers.take_back();  // from a driver that has compiled
    bar.show(done, of, name);
  });
  bar.end();
  if (result.rejected > 0) std::cerr << "oclair: warning: " << rejection_warning(result.rejected) << "\n";
  std::ostream& lines = json_only ? std::cerr : std::cout;
  tune::print_table(result, lines);
  lines << tune::advice(result) << std::endl;
  if (json_only) std::cout << tune::json_of(result) << "\n";
  attempt_all({[&] { if (options.json && !json_only) write_text(*options.json, tune::json_of(result) + "\n"); },
               [&] { if (options.html) write_text(*options.html, tune::report_of(result)); },
               [&] { if (options.settings && !result.interrupted) write_settings(*options.settings, tune::settings_of(result)); }});
  return result.interrupted ? Exit::stopped : Exit::success;
}

}  // namespace

Command tune_command(CLI::App& program) {
  const auto options = std::make_shared<TuneOptions>();
  TuneOptions* const o = options.get();
  CLI::App& line =
      *program.add_subcommand("tune", "Measures what each option that trades speed for accuracy buys and costs on a scene");
  const auto text = [&line](const char* name, const char* type, const char* description, auto store) {
    line.add_option_function<std::string>(name, [=](const std::string& given) { store(name, given); }, description)->type_name(type);
  };
  using Name = const char*;
  using Given = const std::string&;
  add_scene(line, o->request.scene, o->request.definitions);
  text("--error", "E", "relative error that the renders are for, as render --error counts it; default: 0.02",
       [o](Name name, Given given) { o->request.error = real_number(name, given, 0.0, 1e6); });
  text("--budget", "TIME", "how long it may take: 90s, 2m; default: 2m",
       [o](Name name, Given given) { o->request.budget = duration(name, given); });
  text("--confidence", "C", "probability that all intervals hold, in (0, 1); default: 0.95",
       [o](Name name, Given given) { o->request.confidence = real_number(name, given, 0.0, 1.0); });
  text("--size", "WIDTHxHEIGHT", "pictures that are compared; default: what the budget allows, at most the scene's",
       [o](Name name, Given given) { o->request.size = film_size(name, given); });
  text("--replicas", "N", "independent pictures of each setting, 16 samples a pixel; default: 16",
       [o](Name name, Given given) { o->request.replicas = static_cast<unsigned>(whole_number(name, given, 4, 4096)); });
  line.add_option("--json", options->json, "write the results to a file, too, or with - to standard output alone")->type_name("FILE");
  line.add_option("--html", options->html, "write a report: table, plots, pictures of the differences")->type_name("FILE");
  line.add_option("--write", options->settings, "write the recommended settings, for render --settings")->type_name("FILE");
  add_device(line, o->request.device);
  return {&line, [options] { return run(*options); }};
}

}  // namespace oclair
