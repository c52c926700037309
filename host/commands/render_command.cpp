#include <limits>
#include <memory>

#include "../sample_range.h"
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
    options.images.exr = output;
    if (outputs.png)
      options.images.png = outputs.png_file.empty() ? fs::path(output).replace_extension(".png") : fs::path(outputs.png_file);
  } else if (output.extension() == ".png") {
    if (outputs.png)
      throw Error(Exit::usage, "--output '" + output.string() + "': expected a name in .exr when there is --png");
    options.images.png = output;
  } else {
    throw Error(Exit::usage, "--output '" + output.string() + "': expected a name in .exr or .png");
  }
  if (options.images.png && options.images.png->extension() != ".png") {
    throw Error(Exit::usage, "--png '" + options.images.png->string() + "': expected a name in .png");
  }
}

// The checkpoint lies beside the image; who names it, or renders a part, wants it at the end as well.
void choose_checkpoint(RenderOptions& options) {
  options.keep_checkpoint = !options.checkpoint.empty() || options.samples;
  if (options.checkpoint.empty())
    options.checkpoint = fs::path(options.images.exr ? *options.images.exr : *options.images.png).replace_extension(".checkpoint");
}

void refuse_contradictions(const RenderOptions& options) {
  if (options.samples && options.samples_per_pixel)
    throw Error(Exit::usage, "--samples and --spp: expected one of them, both say how many samples there are");
  if (options.aovs.any() && !options.images.exr)
    throw Error(Exit::usage, "--aov: expected an image in .exr, a PNG has no layers");
  if (options.resume && options.restart)
    throw Error(Exit::usage, "--resume and --restart: expected one of them");
}

}  // namespace

Command render_command(CLI::App& program) {
  constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
  const auto options = std::make_shared<RenderOptions>();
  const auto outputs = std::make_shared<Outputs>();
  CLI::App& line = *program.add_subcommand("render", "Renders a scene to an image file");
  const auto text = [&line](const char* name, const char* type, const char* description, auto store) {
    line.add_option_function<std::string>(name, [=](const std::string& given) { store(name, given); }, description)->type_name(type);
  };
  const auto number = [&](const char* name, std::uint64_t least, std::uint64_t most, const char* description, auto store) {
    text(name, "N", description, [=](const char*, const std::string& given) { store(whole_number(name, given, least, most)); });
  };
  using Name = const char*;
  using Given = const std::string&;
  RenderOptions* const o = options.get();  // lives in the command that is returned
  add_scene(line, o->scene, o->definitions);
  line.add_option("-o,--output", outputs->output,
                  "image to write: .exr, or .png alone; default: the scene's name, here, in .exr")
      ->type_name("FILE");
  line.add_option("--png", outputs->png_file, "write a PNG too; without a name: beside the EXR")
      ->type_name("[FILE]")
      ->expected(0, 1);
  text("--aov", "NAME,...", "further layers of the EXR: albedo, normal, depth, uv, primitive",
       [o](Name name, Given given) { o->aovs = aovs(name, given); });

  line.option_defaults()->group("What is rendered");
  text("--size", "WIDTHxHEIGHT", "film in pixels", [o](Name name, Given given) { o->size = film_size(name, given); });
  number("--seed", 0, any, "seed of the random numbers", [o](std::uint64_t n) { o->seed = n; });
  text("--sampler", "independent|sobol", "random numbers: independent ones, or scrambled Sobol points; default: sobol",
       [o](Name name, Given given) { o->sampler = sampler(name, given); });
  number("--max-depth", 0, std::numeric_limits<unsigned>::max(), "longest path, in segments; 1: directly visible light only",
         [o](std::uint64_t n) { o->max_depth = static_cast<unsigned>(n); });
  text("--fresnel", "exact|schlick", "reflectance of dielectrics and conductors: exact, or Schlick's approximation; default: exact",
       [o](Name name, Given given) { o->approximations = fresnel(name, given); });
  text("--arithmetic", "float|double",
       "what the samples are computed in: an image in double shows, by comparison, where rounding counts; default: float",
       [o](Name name, Given given) { o->double_precision = double_precision(name, given); });
  text("--kernels", "shared|exact",
       "shared: the smallest of four kernels that holds what the scene needs; exact: one with just that; default: shared",
       [o](Name name, Given given) { o->exact_kernel = exact_kernel(name, given); });

  number("--film-memory", 1, 1 << 24, "MiB that the film may take on the device: a larger one is there band by band; default: what there is",
         [o](std::uint64_t n) { o->device_memory = static_cast<std::size_t>(n) << 20; });
  add_host_memory(line, o->host_memory);

  line.option_defaults()->group("When it ends: whichever comes first");
  number("--spp", 1, MAX_SAMPLES, "samples per pixel", [o](std::uint64_t n) { o->samples_per_pixel = n; });
  text("--time", "TIME", "seconds since the program started, or 90s, 2m, 1.5h",
       [o](Name name, Given given) { o->seconds = duration(name, given); });
  text("--error", "E", "the image's relative error is below E, e.g. 0.02: docs/progressive.md",
       [o](Name name, Given given) { o->error = real_number(name, given, 0.0, 1e6); });
  text("--confidence", "C", "probability of that, in (0, 1); default: 0.95",
       [o](Name name, Given given) { o->confidence = real_number(name, given, 0.0, 1.0); });

  line.option_defaults()->group("Going on, and parts of a render");
  text("--checkpoint", "FILE", "where the render is kept on the way, and at its end; default: beside the image, until it is done",
       [o](Name, Given given) { o->checkpoint = given; });
  text("--every", "TIME", "time between two checkpoints; default: 30s",
       [o](Name name, Given given) { o->checkpoint_every = duration(name, given); });
  line.add_flag("--resume", o->resume, "go on from the checkpoint, if it is there");
  line.add_flag("--restart", o->restart, "drop a checkpoint that is there");
  text("--samples", "FIRST:COUNT", "only these samples of each pixel, for `oclair merge`",
       [o](Name name, Given given) { o->samples = sample_range(name, given); });

  line.option_defaults()->group("Watching it");
  text("--progress", "text|json", "on standard error: lines for people, or an event a line in JSON; default: text",
       [o](Name name, Given given) { o->progress_json = progress_json(name, given); });
  text("--tev", "HOST[:PORT]", "show it in the viewer tev", [o](Name name, Given given) { o->viewer = parse_host_port(name, given); });
  line.option_defaults()->group("Options");
  add_device(line, o->device);
  return {&line, [&line, options, outputs] {
            outputs->png = line.count("--png") > 0;
            choose_files(*outputs, *options);
            refuse_contradictions(*options);
            choose_checkpoint(*options);
            return render(*options);
          }};
}

}  // namespace oclair
