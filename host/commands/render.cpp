#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>

#include "../film.h"
#include "../header.h"
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
  world.keep_uvs = options.aovs.uv;
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

void write_images(const RenderOptions& options, const WorldFilm& f, const std::string& moment_name, const Film& film,
                  const std::vector<Layer>& layers, const ImageAttributes& attributes) {
  if (options.exr) {
    write_exr(*options.exr, {f.width, f.height, f.crop_x, f.crop_y, f.crop_width, f.crop_height},
              parts_of(film, f.pixel_format, moment_name, layers), attributes);
  }
  if (options.png) {
    const std::vector<float> rgb = rgb_of(film);
    const std::span<const float> values(rgb);
    write_png(*options.png, film.width, film.height, {{{values, 3}, {values.subspan(1), 3}, {values.subspan(2), 3}}});
  }
}

}  // namespace

Exit render(const RenderOptions& options) {
  const std::optional<std::int64_t> date = reproducible_date();
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
  scene.exact_kernel = options.exact_kernel;
  const Bvh bvh = build_bvh(scene, device.bvh_width);
  scene.positions = {};
  scene.triangles = {};
  progress.begin("kernels");
  Renderer renderer = start_render(device, scene, bvh);
  progress.begin("passes");
  render_passes(renderer, samples_per_pixel, progress);
  std::vector<Layer> layers;
  if (options.exr && options.aovs.any()) {
    progress.begin("layers");
    layers = render_aovs(renderer, scene, bvh, options.aovs);
  }
  progress.begin("write");
  const Film film = read_film(renderer);
  const std::uint64_t rejected = rejected_samples(film);
  const Origin origin{options.scene.filename().string(), "", command_line(), ""};
  Figures figures;
  figures.ranges = {{0, samples_per_pixel}};
  figures.rejected = rejected;
  write_images(options, window, moment_name, film, layers,
               header_attributes(header_texts(origin, scene, device), figures, date));
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
          "--kernels", [options](const std::string& given) { options->exact_kernel = exact_kernel("--kernels", given); },
          "shared: the smallest of four kernels that holds what the scene needs; exact: one with just that; default: shared")
      ->type_name("shared|exact");
  line.add_option_function<std::string>(
          "--aov", [options](const std::string& given) { options->aovs = aovs("--aov", given); },
          "further layers of the EXR: albedo, normal, depth, uv, primitive")
      ->type_name("NAME,...");
  add_device(line, options->device);
  return {&line, [&line, options, outputs] {
            outputs->png = line.count("--png") > 0;
            choose_files(*outputs, *options);
            return render(*options);
          }};
}

}  // namespace oclair
