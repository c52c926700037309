#include <unistd.h>

#include <iostream>
#include <limits>
#include <system_error>

#include "../checkpoint_lock.h"
#include "../file_aside.h"
#include "../film.h"
#include "../scene_hash.h"
#include "../settings_file.h"
#include "../signals.h"
#include "commands.h"
#include "output.h"
#include "render_loop.h"
#include "report.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

// Phases as the progress shows them, and how long each took.
class Phases {
 public:
  explicit Phases(Progress& progress) : progress_(progress) {}

  void begin(const char* phase, std::uint64_t samples_before = 0) {
    end();
    progress_.begin(phase, samples_before);
    seconds_.emplace_back(phase, 0.0);
    begun_ = steady_seconds();
  }
  void end() {
    progress_.end();
    if (begun_) seconds_.back().second = steady_seconds() - *begun_;
    begun_.reset();
  }
  std::vector<std::pair<std::string, double>> seconds() const {
    auto all = seconds_;
    if (begun_) all.back().second = steady_seconds() - *begun_;
    return all;
  }

 private:
  Progress& progress_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::optional<double> begun_;
};

void apply(const RenderOptions& options, World& world) {
  if (options.samples_per_pixel) world.samples_per_pixel = *options.samples_per_pixel;
  if (options.seed) world.seed = *options.seed;
  world.keep_uvs = options.aovs.uv;
}

// Without --spp, --time and --error are limits by themselves: then there is none of samples.
bool has_sample_limit(const RenderOptions& options) {
  return options.samples || options.samples_per_pixel || !(options.seconds || options.error);
}

SampleRange wanted_samples(const RenderOptions& options, std::uint64_t samples_of_scene) {
  if (options.samples) return *options.samples;
  return {0, has_sample_limit(options) ? samples_of_scene : MAX_SAMPLES};
}

// A film of this render, and what lies beside it.
FilmLimits film_limits(const RenderOptions& options) {
  FilmLimits limits{options.device_memory, options.host_memory, directory_of(options.checkpoint), 0, 0};
  if (options.error) limits.error_bytes = sizeof(ErrorMonitor::Pixel);
  if (options.images.exr) limits.layer_bytes = channel_count(options.aovs) * sizeof(float);
  return limits;
}

// All on which the samples depend, beside the size of the film, which the film itself tells.
Identity identity_of(const Scene& scene, const std::string& hash) {
  const Settings& settings = scene.settings;
  return {{"program", OCLAIR_VERSION},
          {"kernels", kernel_hash()},
          {"scene", hash},
          {"seed", std::to_string(settings.seed)},
          {"sampler", name_of(static_cast<SamplerKind>(settings.sampler))},
          {"max depth", std::to_string(settings.max_depth)},
          {"rr depth", std::to_string(settings.rr_depth)},
          {"features", feature_names(scene.features)},  // which model each option left
          {"approximations", approximation_names(scene)},
          {"arithmetic", arithmetic_name(scene)}};
}

// Throws unless the checkpoint is one of this render. Its head.
Checkpoint require_resumable(const fs::path& path, const SampleRange& wanted, const Checkpoint& state) {
  Checkpoint earlier = read_checkpoint_head(path);
  require_same(with_film(state), with_film(earlier), path.string());
  const SampleRange& range = earlier.ranges.front();
  if (earlier.ranges.size() > 1)
    throw Error(Exit::render_failed, path.string() + ": has been merged from several ranges of samples, expected one range");
  if (range.first != wanted.first)
    throw Error(Exit::render_failed, path.string() + ": its samples begin at " + std::to_string(range.first) + ", expected " +
                                 std::to_string(wanted.first));
  if (range.count > wanted.count)
    throw Error(Exit::render_failed, path.string() + ": holds " + std::to_string(range.count) + " samples per pixel, expected at most the " +
                                 std::to_string(wanted.count) + " that are wanted");
  return earlier;
}

// "DEVICE (DRIVER)", if the head knows it.
std::string device_of(const ImageHead& head) {
  std::string device, driver;
  for (const auto& [name, value] : head.attributes)
    if (name == "device")
      device = value;
    else if (name == "driver")
      driver = value;
  return device.empty() ? "an unknown device" : one_line(device + " (" + driver + ")");
}

// Samples of two devices go together, but their sum is not what either of them would have computed. Empty: there is one.
std::string device_warning(const fs::path& checkpoint, const ImageHead& earlier, const ImageHead& now) {
  const std::string before = device_of(earlier), here = device_of(now);
  if (before == here) return "";
  return checkpoint.string() + ": was rendered by " + before + " and goes on with " + here +
         ": the samples are as good, but their bits may differ";
}

// What was asked for has been reached: the error, or else the samples, or else the time.
bool reached(const RenderOptions& options, Stop stop) {
  if (stop == Stop::signal) return false;
  if (options.error) return stop == Stop::error;
  if (has_sample_limit(options)) return stop == Stop::samples;
  return true;
}

// What stands in the way of the checkpoint, before the long work.
void require_free(const RenderOptions& options) {
  if (!fs::exists(options.checkpoint)) return;
  if (!options.resume && !options.restart)
    throw Error(Exit::usage, options.checkpoint.string() +
                                 ": is there from an earlier render, expected --resume to go on with it or --restart to drop it");
  if (!begins_like_checkpoint(options.checkpoint))
    throw Error(Exit::render_failed, options.checkpoint.string() + ": is not a checkpoint, expected one or no file");
}

void remove_checkpoint(const fs::path& path) {
  std::error_code ignored;  // what is left of it does no harm
  if (fs::is_regular_file(path, ignored)) fs::remove(fs::weakly_canonical(path, ignored), ignored);
}

// Where all that is lit has fewer digits than float32 should have, down to none. Empty: there is enough light, or none at
// all.
std::string light_warning(const Settings& settings) {
  if (settings.light_count == 0 || settings.film_exponent >= std::numeric_limits<float>::min_exponent) return "";
  return "the lights are so weak that what they light is below the smallest normal float, 1.2e-38, and loses digits: "
         "expected more light";
}

// What was measured holds for the choices of the settings file together: for no others that change the samples.
bool has_been_measured(const SettingsFile& settings, const Choices& chosen) {
  return std::all_of(choices().begin(), choices().end(), [&](const Choice& choice) {
    return choice.effect == Effect::none || choice.get(chosen) == choice.get(settings.choices);
  });
}

// For the image's header: the choices of a settings file, with what was measured of them if nothing else was chosen.
std::string settings_text(const SettingsFile& settings, const Choices& chosen) {
  std::string text = text_of(settings.choices);
  if (has_been_measured(settings, chosen)) {
    for (const auto& [name, value] : settings.measured) text += " " + name + "=" + value;
  } else {
    text += " changed to " + text_of(chosen);
  }
  return one_line(text + " of " + settings.scene + " " + settings.scene_hash);
}

std::string options_text(const RenderOptions& options, const Scene& scene) {
  std::string text = "maxDepth=" + std::to_string(scene.settings.max_depth) + " rrDepth=" + std::to_string(scene.settings.rr_depth);
  for (const auto& [name, value] : options.definitions) text += " -D" + name + "=" + value;
  return text;
}

}  // namespace

Exit render(const RenderOptions& options) {
  const double started = steady_seconds();
  const SignalHandlers handlers;
  reproducible_date();  // wrong ones are refused now
  const std::optional<SettingsFile> settings = options.settings ? std::optional(read_settings(*options.settings)) : std::nullopt;
  const Choices chosen = settings ? joined(settings->choices, options.choices) : options.choices;
  require_distinct(options.images, options.checkpoint, {options.scene});
  require_writable(options.images);
  const CheckpointLock lock(options.checkpoint);
  require_free(options);
  const bool resumes = options.resume && fs::exists(options.checkpoint);
  require_writable(options.checkpoint);
  const Device device = open_device(options.device);
  if (chosen.arithmetic == Arithmetic::double_precision) require_double_precision(device);
  Progress progress =
      options.progress_json ? Progress::json(std::cerr) : Progress(std::cerr, isatty(STDERR_FILENO) != 0);
  Phases phases(progress);
  const auto heed_signals = [&] {  // before there is anything to write
    if (!stop_requested()) return;
    progress.finish("signal", static_cast<int>(Exit::stopped));
    throw Error(Exit::stopped, "stopped by a signal before the first sample: nothing is written");
  };

  const ReadOptions reading{options.size, [&](const char* phase) { phases.begin(phase); }};
  World world = read_scene(options.scene, options.definitions, reading);
  phases.end();
  for (const std::string& warning : world.warnings) progress.warning(warning);
  heed_signals();
  std::vector<fs::path> inputs;
  for (const SceneFile& file : world.files) inputs.push_back(file.path);
  require_distinct(options.images, options.checkpoint, inputs);
  apply(options, world);
  const SampleRange wanted = wanted_samples(options, world.samples_per_pixel);
  const std::string hash = scene_hash(world, options.definitions);
  if (settings && settings->scene_hash != hash)
    progress.warning(options.settings->string() + ": was measured on another scene, " + one_line(settings->scene) + ' ' +
                     one_line(settings->scene_hash) + ": what it says of the bias need not hold for this one");
  if (settings && !has_been_measured(*settings, chosen))
    progress.warning(options.settings->string() + ": the options of the command line make it " + text_of(chosen) +
                     ": what it says of the bias is of " + text_of(settings->choices));
  Checkpoint state;
  state.head.film = world.film;
  state.head.moment_name = world.integrator.moment_name;

  phases.begin("BVH");
  Scene scene = place_scene(std::move(world));
  apply(chosen, scene);
  if (const std::string warning = light_warning(scene.settings); !warning.empty()) progress.warning(warning);
  state.identity = identity_of(scene, hash);
  state.head.attributes = header_texts({options.scene.filename().string(), hash, command_line(), options_text(options, scene)}, scene, device);
  if (settings) state.head.attributes.emplace_back("settings", settings_text(*settings, chosen));
  state.film.width = scene.settings.crop_width;
  state.film.height = scene.settings.crop_height;
  state.film.exponent = scene.settings.film_exponent;
  state.kept = options.keep_checkpoint;
  if (resumes) {
    const Checkpoint earlier = require_resumable(options.checkpoint, wanted, state);
    state.kept = state.kept || earlier.kept;
    if (const std::string warning = device_warning(options.checkpoint, earlier.head, state.head); !warning.empty())
      progress.warning(warning);
  }
  const Bvh bvh = build_bvh(scene, bvh_width(chosen, device));
  scene.positions = {};
  scene.triangles = {};

  heed_signals();
  phases.end();
  const FilmPlan film_plan = plan_film(device, scene, plan_buffers(scene, bvh), film_limits(options));
  progress.memory("film: " + film_text(film_plan), film_plan.whole);
  std::optional<ErrorMonitor> monitor;
  if (options.error)
    monitor.emplace(*options.error, options.confidence, ErrorMonitor::usual_block, film_plan.directory,
                    std::size_t{state.film.width} * state.film.height);
  phases.begin("kernels");
  Renderer renderer = start_render(device, scene, bvh, film_plan);
  renderer.first_sample = wanted.first;
  if (options.images.exr && options.aovs.any()) {
    phases.begin("layers");
    state.layers = render_aovs(renderer, scene, bvh, options.aovs);
  }
  handlers.take_back();
  if (resumes) {
    take_film(renderer, state.film);  // its arrays, for those of the file
    restore_film(renderer, read_checkpoint(options.checkpoint, std::move(state.film)).film);
  }

  phases.begin("passes", renderer.samples * scene.settings.crop_width * scene.settings.crop_height);
  std::optional<TevClient> viewer;
  if (options.viewer) viewer.emplace(*options.viewer);
  OnTheWay way;
  const auto tell_files = [&] {
    for (const auto& file : {options.images.exr, options.images.png})
      if (file) progress.wrote_file(file->string());
  };
  way.write_picture = [&](const Checkpoint& now) {
    write_images(options.images, now, {"", phases.seconds()});
    tell_files();
  };
  way.write_checkpoint = [&](const Checkpoint& now) {
    write_checkpoint(options.checkpoint, now);
    progress.wrote_checkpoint(options.checkpoint.string());
  };
  way.checkpoint_every = options.checkpoint_every;
  way.viewer = viewer ? &*viewer : nullptr;
  const Limits limits{wanted.count, !has_sample_limit(options), options.seconds, monitor ? &*monitor : nullptr};
  const Stop stop = render_until(limits, renderer, state, way, progress, started);
  if (renderer.samples == 0) heed_signals();

  phases.begin("write");
  take_film(renderer, state);
  const bool done = reached(options, stop);
  // A checkpoint that nobody asked for has served when the image is there.
  bool keeps = state.kept || !done;
  attempt_all({[&] {
                 try {
                   write_images(options.images, state, {std::string(name_of(stop)), phases.seconds()});
                 } catch (const std::exception&) {
                   keeps = true;  // what has been rendered is not lost: --resume writes the image
                   throw;
                 }
               },
               [&] { if (keeps) way.write_checkpoint(state); }});
  if (!keeps) remove_checkpoint(options.checkpoint);
  phases.end();
  if (const std::string warning = rejection_warning(rejected_samples(state.film)); !warning.empty()) progress.warning(warning);
  tell_files();
  print_files(options.images);
  const Exit exit = done ? Exit::success : Exit::stopped;
  progress.finish(std::string(name_of(stop)), static_cast<int>(exit));
  return exit;
}

}  // namespace oclair
