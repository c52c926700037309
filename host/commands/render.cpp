#include <iostream>
#include <limits>
#include <memory>

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

}  // namespace

Exit render(const RenderOptions& options) {
  std::cout << options.scene.string();
  if (options.exr) std::cout << " " << options.exr->string();
  if (options.png) std::cout << " " << options.png->string();
  std::cout << "\n";
  return Exit::success;
}

Command render_command(CLI::App& program) {
  constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
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
  number("--spp", 1, any, "samples per pixel", [options](std::uint64_t n) { options->samples_per_pixel = n; });
  number("--seed", 0, any, "seed of the random numbers", [options](std::uint64_t n) { options->seed = n; });
  number("--max-depth", 0, std::numeric_limits<unsigned>::max(), "longest path, in segments; 1: directly visible light only",
         [options](std::uint64_t n) { options->max_depth = static_cast<unsigned>(n); });
  line.add_option_function<std::string>(
          "--size", [options](const std::string& given) { options->size = film_size("--size", given); }, "film in pixels")
      ->type_name("WIDTHxHEIGHT");
  add_device(line, options->device);
  return {&line, [&line, options, outputs] {
            outputs->png = line.count("--png") > 0;
            choose_files(*outputs, *options);
            return render(*options);
          }};
}

}  // namespace oclair
