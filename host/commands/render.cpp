#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>

#include "../film.h"
#include "../image.h"
#include "../layers.h"
#include "../progress.h"
#include "report.h"
#include "options.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

// What the command line says about the files, before it is known which are written.
struct Outputs {
  std::string output;  // empty: the scene's name, here, as EXR
  bool png = false;
  std::string png_file;  // empty: beside the EXR
};

// With -o x.png only that is written; --png writes a PNG next to the EXR, or the file that it names.
void choose_files(const Outputs& outputs, RenderOptions& options) {
  const fs::path output = outputs.output.empty() ? options.scene.stem() += ".exr" : fs::path(outputs.output);
  if (output.extension() == ".exr") {
    options.exr = output;
    if (outputs.png)
      options.png = outputs.png_file.empty() ? fs::path(output).replace_extension(".png") : fs::path(outputs.png_file);
  } else if (output.extension() == ".png") {
    if (outputs.png)
      throw Error(Exit::usage, "--output '" + output.string() + "': expected a name in .exr when there is --png");
    options.png = output;
  } else {
    throw Error(Exit::usage, "--output '" + output.string() + "': expected a name in .exr or .png");
  }
  if (options.png && options.png->extension() != ".png") {
    throw Error(Exit::usage, "--png '" + options.png->string() + "': expected a name in .png");
  }
}

void apply(const RenderOptions& options, World& world) {
  if (options.samples_per_pixel) world.samples_per_pixel = *options.samples_per_pixel;
  if (options.seed) world.seed = *options.seed;
  if (options.max_depth) world.integrator.max_depth = *options.max_depth;
  if (options.sampler) world.sampler = *options.sampler;
}

void render_passes(Renderer& renderer, std::uint64_t samples_per_pixel, Progress& progress) {
  const std::uint64_t pixels = std::uint64_t{renderer.settings.crop_width} * renderer.settings.crop_height;
  while (renderer.samples < samples_per_pixel) {
    // Passes of 1, 1, 2, 4, ... samples: the bar moves soon, then there is little overhead. The film does not depend on the split.
    const std::uint64_t wanted = std::clamp<std::uint64_t>(renderer.samples, 1, 16);
    const uint samples = static_cast<uint>(std::min(wanted, samples_per_pixel - renderer.samples));
    const std::uint64_t before = renderer.samples * pixels;
    render_pass(renderer, samples, [&](double share) {
      progress.samples(before + static_cast<std::uint64_t>(share * static_cast<double>(samples * pixels)),
                       samples_per_pixel * pixels);
    });
  }
}

std::string feature_names(Features features) {
  std::string names;
#define FEATURE_NAME(name, bit, description) \
  if (features & FEATURE_##name) names += (names.empty() ? "" : " ") + std::string(#name);
  FEATURE_LIST(FEATURE_NAME)
#undef FEATURE_NAME
  return names;
}

// What was asked for at the price of accuracy, on the command line or by the scene's materials.
std::string approximation_names(const Scene& scene) {
  std::string names;
  const auto add = [&](const char* name) { names += (names.empty() ? "" : " ") + std::string(name); };
#define APPROXIMATION_NAME(name, bit, description) \
  if (scene.approximations & APPROXIMATION_##name) add(description);
  APPROXIMATION_LIST(APPROXIMATION_NAME)
#undef APPROXIMATION_NAME
  if (scene.features & FEATURE_OREN_NAYAR_FAST) add("oren_nayar=qualitative");
  return names.empty() ? "none" : names;
}

// What made the image; nothing that differs between two equal runs.
ImageAttributes attributes_of(const RenderOptions& options, const Scene& scene, const Device& device, std::uint64_t samples,
                              std::uint64_t rejected) {
  return {{"software", "oclair " OCLAIR_VERSION},
          {"scene", options.scene.filename().string()},
          {"samplesPerPixel", std::to_string(samples)},
          {"seed", std::to_string(scene.settings.seed)},
          {"sampler", scene.settings.sampler == SAMPLER_SOBOL ? "sobol" : "independent"},
          {"features", feature_names(scene.features)},
          {"approximations", approximation_names(scene)},
          {"device", device.name + " (" + device.platform + ")"},
          {"rejectedSamples", std::to_string(rejected)}};
}

void write_images(const RenderOptions& options, const WorldFilm& f, const std::string& moment_name, const Film& film,
                  const ImageAttributes& attributes) {
  if (options.exr) {
    const std::vector<Layer> layers = layers_of(film, f.pixel_format, moment_name);
    ImageChannels channels;
    for (const Layer& layer : layers) channels.push_back({layer.name, {layer.values}});
    write_exr(*options.exr, {f.width, f.height, f.crop_x, f.crop_y, f.crop_width, f.crop_height}, channels, attributes);
  }
  if (options.png) {
    const std::vector<float> rgb = rgb_of(film);
    const std::span<const float> values(rgb);
    write_png(*options.png, film.width, film.height, {{{values, 3}, {values.subspan(1), 3}, {values.subspan(2), 3}}});
  }
}

}  // namespace

Exit render(const RenderOptions& options) {
  if (options.exr) require_writable(*options.exr);
  if (options.png) require_writable(*options.png);
  const Device device = open_device(options.device);
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const ReadOptions reading{options.size, [&](const char* phase) { progress.begin(phase); }};
  World world = read_scene(options.scene, options.definitions, reading);
  progress.end();
  print_warnings(world, std::cerr);
  apply(options, world);
  progress.begin("BVH");
  const WorldFilm window = world.film;
  const std::string moment_name = world.integrator.moment_name;
  const std::uint64_t samples_per_pixel = world.samples_per_pixel;
  Scene scene = place_scene(std::move(world));
  // What the scene has no use for is neither compiled nor recorded.
  constexpr Features with_fresnel = FEATURE_CONDUCTOR | FEATURE_DIELECTRIC | FEATURE_THIN_DIELECTRIC;
  if (scene.features & with_fresnel) scene.approximations = options.approximations;
  const Bvh bvh = build_bvh(scene, device.bvh_width);
  scene.positions = {};
  scene.triangles = {};
  progress.begin("kernels");
  Renderer renderer = start_render(device, scene, bvh);
  progress.begin("passes");
  render_passes(renderer, samples_per_pixel, progress);
  progress.begin("write");
  const Film film = read_film(renderer);
  const std::uint64_t rejected = rejected_samples(film);
  write_images(options, window, moment_name, film, attributes_of(options, scene, device, samples_per_pixel, rejected));
  progress.end();  // ends its line first: on a terminal both streams are one
  for (const auto& written : {options.exr, options.png})
    if (written) std::cout << written->string() << "\n";
  if (rejected > 0)
    std::cerr << "oclair: warning: " << rejected << " samples were not finite, negative or too large and are left out\n";
  return Exit::success;
}

Command render_command(CLI::App& program) {
  constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
  constexpr std::uint64_t most_samples = std::uint64_t{1} << 33;  // what rng_key and the film's sums can number
  const auto options = std::make_shared<RenderOptions>();
  const auto outputs = std::make_shared<Outputs>();
  CLI::App& line = *program.add_subcommand("render", "Renders a scene to an image file");
  add_scene(line, options->scene, options->definitions);
  line.add_option("-o,--output", outputs->output,
                  "image to write: .exr, or .png alone; default: the scene's name, here, in .exr")
      ->type_name("FILE");
  line.add_option("--png", outputs->png_file, "write a PNG too; without a name: beside the EXR")
      ->type_name("[FILE]")
      ->expected(0, 1);
  const auto number = [&line](const char* name, std::uint64_t least, std::uint64_t most, const char* description,
                              auto store) {
    line.add_option_function<std::string>(
            name, [=](const std::string& given) { store(whole_number(name, given, least, most)); }, description)
        ->type_name("N");
  };
  number("--spp", 1, most_samples, "samples per pixel", [options](std::uint64_t n) { options->samples_per_pixel = n; });
  number("--seed", 0, any, "seed of the random numbers", [options](std::uint64_t n) { options->seed = n; });
  number("--max-depth", 0, std::numeric_limits<unsigned>::max(), "longest path, in segments; 1: directly visible light only",
         [options](std::uint64_t n) { options->max_depth = static_cast<unsigned>(n); });
  line.add_option_function<std::string>(
          "--size", [options](const std::string& given) { options->size = film_size("--size", given); }, "film in pixels")
      ->type_name("WIDTHxHEIGHT");
  line.add_option_function<std::string>(
          "--fresnel", [options](const std::string& given) { options->approximations = fresnel("--fresnel", given); },
          "reflectance of dielectrics and conductors: exact, or Schlick's approximation; default: exact")
      ->type_name("exact|schlick");
  line.add_option_function<std::string>(
          "--sampler", [options](const std::string& given) { options->sampler = sampler("--sampler", given); },
          "random numbers: independent ones, or scrambled Sobol points; default: independent")
      ->type_name("independent|sobol");
  add_device(line, options->device);
  return {&line, [&line, options, outputs] {
            outputs->png = line.count("--png") > 0;
            choose_files(*outputs, *options);
            return render(*options);
          }};
}

}  // namespace oclair
