// Scrambled Sobol points against independent numbers: the error that they leave, and the time that they take.
#include <algorithm>
#include <cmath>
#include <memory>

#include "../film.h"
#include "bench.h"
#include "child.h"
#include "machine.h"
#include "subjects.h"

namespace oclair::bench {
namespace {

constexpr unsigned samples = 16 * REPLICA_SAMPLES;  // per pixel, of which the error is taken
constexpr unsigned timed_samples = 2 * REPLICA_SAMPLES;
constexpr unsigned film_side = 96;  // pixels, the longer one

World small_world(const std::filesystem::path& file, const Definitions& definitions) {
  World world = read_scene(file, definitions);
  const double shrink = static_cast<double>(film_side) / std::max(world.film.width, world.film.height);
  const auto side = [&](uint pixels) { return std::max(1u, static_cast<uint>(std::lround(shrink * pixels))); };
  return read_scene(file, definitions, {glm::uvec2(side(world.film.width), side(world.film.height)), {}});
}

struct Sampled {
  Scene scene;
  Bvh bvh;
  std::unique_ptr<Renderer> renderer;

  Sampled(const Device& device, World world, SamplerKind sampler) {
    world.sampler = sampler;
    scene = place_scene(std::move(world));
    bvh = build_bvh(scene, device.bvh_width);
    renderer = std::make_unique<Renderer>(start_render(device, scene, bvh));
  }
};

// Of the mean of one sample: mean over pixels and channels of the squared standard error times the samples, and the same
// relative to the square of the pixel, dark ones (below a tenth of the mean) like those of a tenth.
struct Errors {
  double absolute = 0.0, relative = 0.0;
};

Errors errors_of(const Film& film) {
  double mean = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i)
    for (const double x : pixel_mean(film, i)) mean += x / (3.0 * static_cast<double>(film.pixels.size()));
  Errors errors;
  const double weight = static_cast<double>(film.samples) / (3.0 * static_cast<double>(film.pixels.size()));
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const auto pixel = pixel_mean(film, i);
    const auto error = pixel_standard_error(film, i);
    for (int c = 0; error && c < 3; ++c) {
      const double squared = weight * (*error)[c] * (*error)[c];
      errors.absolute += squared;
      errors.relative += squared / std::pow(std::max(pixel[c], 0.1 * mean), 2.0);
    }
  }
  return errors;
}

void compare(const Options& options, const std::filesystem::path& file, const Definitions& definitions, Table& table) {
  const Device device = open_device(options.device);
  const World world = small_world(file, definitions);
  Sampled sobol(device, world, SAMPLER_SOBOL), independent(device, world, SAMPLER_INDEPENDENT);
  Errors errors[2];
  std::vector<Contender> contenders;
  for (Sampled* sampled : {&sobol, &independent}) {
    render_pass(*sampled->renderer, samples);
    errors[sampled == &independent] = errors_of(read_film(*sampled->renderer));
    contenders.push_back({{}, timed_on_cpu([sampled] { render_pass(*sampled->renderer, timed_samples); })});
  }
  const auto seconds = measure(contenders, options.rounds);
  const Spread slower = ratio_of(seconds[0], seconds[1]);
  const double pixels = static_cast<double>(world.film.crop_width) * world.film.crop_height;
  const auto per_sample = [&](const Seconds& s) { return spread_of(s).median * 1e6 / (timed_samples * pixels); };
  const auto gain = [](double of, double over) { return Spread{over / of, over / of, over / of}; };
  const std::string name = file.stem().string() + " Sobol against independent: ";
  table.add({name + "time", "us/sample", per_sample(seconds[0]), per_sample(seconds[1]), slower});
  table.add({name + "variance", "", errors[0].absolute, errors[1].absolute, gain(errors[0].absolute, errors[1].absolute)});
  table.add({name + "relative variance", "", errors[0].relative, errors[1].relative,
             gain(errors[0].relative, errors[1].relative)});
  const double speedup = errors[1].relative / errors[0].relative / slower.median;
  table.add({name + "relative variance at equal time", "", {}, {}, Spread{speedup, speedup, speedup}});
}

}  // namespace

void bench_sampler(const Options& options, Table& table) {
  std::vector<std::filesystem::path> files;
  if (options.scene) files.push_back(*options.scene);
  for (const char* name : {"cornell-boxes", "cornell", "lambert", "oren-nayar", "disney-diffuse", "normal-map", "bricks",
                           "mirror-glass", "diamond"})
    if (const auto file = own_scene(name); file && !options.scene) files.push_back(*file);
  table.heading("samplers, films of at most " + std::to_string(film_side) + " pixels a side, " + std::to_string(samples) +
                " samples in replicas of " + std::to_string(REPLICA_SAMPLES));
  for (const auto& file : files)
    table.take(in_child([&] {
      Table rows = table.empty_copy();
      compare(options, file, options.scene ? options.definitions : Definitions{}, rows);
      return rows.json();
    }));
}

}  // namespace oclair::bench
