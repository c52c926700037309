#include <iomanip>
#include <iostream>
#include <memory>
#include <utility>

#include "../checkpoint.h"
#include "../image_info.h"
#include "../render.h"
#include "../variant.h"
#include "options.h"
#include "report.h"

namespace oclair {

namespace {

void print_film(const WorldFilm& film, std::uint64_t samples_per_pixel) {
  const char* const filters[] = {"box", "tent", "gaussian"};
  row("film") << film.crop_width << "x" << film.crop_height;
  if (film.crop_width != film.width || film.crop_height != film.height)
    std::cout << " at " << film.crop_x << "," << film.crop_y << " of " << film.width << "x" << film.height;
  std::cout << ", " << filters[static_cast<int>(film.filter)] << " filter, " << samples_per_pixel
            << " samples per pixel\n";
}

void print_features(Features features) {
#define FEATURE_ROW(name, bit, variant, description) \
  if (features & FEATURE_##name) row("feature") << #name << ": " << description << "\n";
  FEATURE_LIST(FEATURE_ROW)
#undef FEATURE_ROW
}

void print_memory(const Device& device, const Scene& scene, const Bvh& bvh) {
  std::vector<BufferPlan> buffers = plan_buffers(scene, bvh);
  const FilmPlan film = plan_film(device, scene, buffers);
  const std::vector<BufferPlan> of_scene = buffers;
  buffers.push_back({"film", nullptr, film.film});
  buffers.push_back({"moments", nullptr, film.moments});
  buffers.push_back({"errors", nullptr, film.errors});
  std::size_t sum = 0;
  for (const BufferPlan& buffer : buffers) {
    if (buffer.bytes > 0) row("buffer") << buffer.name << ": " << format_bytes(buffer.bytes) << "\n";
    sum += buffer.bytes;
  }
  row("memory") << format_bytes(sum) << " on the device\n";
  row("film") << film_text(film) << "\n";
  try {
    check_memory(device, of_scene, film);
  } catch (const Error& error) {
    row("too much") << error.what() << "\n";
  }
  if (!scene.triangles.empty())
    row("per triangle") << std::fixed << std::setprecision(1) << bytes_per_triangle(scene, bvh)
                        << " bytes of nodes, blocks and what shading reads\n";
}

}  // namespace

Exit info(const InfoOptions& options) {
  if (is_exr(options.scene)) return info_image(options.scene);
  if (begins_like_checkpoint(options.scene) || options.scene.extension() == ".checkpoint")
    return info_checkpoint(options.scene);
  const Device device = open_device(options.device);
  World world = read_scene(options.scene, options.definitions, {options.size, {}});
  print_warnings(world, std::cerr);
  const WorldFilm film = world.film;
  const std::uint64_t samples_per_pixel = world.samples_per_pixel;
  const Scene scene = place_scene(std::move(world));
  const Bvh bvh = build_bvh(scene, device.bvh_width);
  row("scene") << options.scene.string() << "\n";
  print_film(film, samples_per_pixel);
  row("triangles") << scene.triangles.size() << "\n";
  if (scene.degenerate_primitives > 0) row("left out") << scene.degenerate_primitives << " primitives without area\n";
  row("quadrics") << scene.quadrics.size() << "\n";
  row("lights") << scene.lights.size() << "\n";
  row("BVH") << bvh.node_count << " nodes of width " << bvh.width << ", " << bvh.block_count << " leaf blocks, depth "
             << bvh.depth << "\n";
  print_features(scene.features);
  const KernelOptions kernel = kernel_options(scene, bvh);
  row("kernel") << "render in path.cl, " << name_of(variant_of(scene.features)) << ": features 0x" << std::hex << kernel.features << std::dec << ", width "
                << kernel.bvh_width << ", stack of " << kernel.stack_size << "\n";
  row("device") << device.name << "\n";
  print_memory(device, scene, bvh);
  return Exit::success;
}

Command info_command(CLI::App& program) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App& line = *program.add_subcommand(
      "info", "Says what a scene holds and what it requires, or what an OpenEXR image or a checkpoint holds");
  add_scene(line, options->scene, options->definitions);
  line.add_option_function<std::string>(
          "--size", [options](const std::string& given) { options->size = film_size("--size", given); }, "film in pixels, as for render")
      ->type_name("WIDTHxHEIGHT");
  add_device(line, options->device);
  return {&line, [options] { return info(*options); }};
}

}  // namespace oclair
