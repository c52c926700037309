#include "output.h"

#include <algorithm>
#include <exception>
#include <iostream>

#include "../error.h"
#include "../film.h"

namespace oclair {

void require_writable(const ImageFiles& files) {
  if (files.exr) require_writable(*files.exr);
  if (files.png) require_writable(*files.png);
}

void require_distinct(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs) {
  const auto canonical = [](const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(path, ignored);
  };
  std::vector<std::filesystem::path> taken;
  for (const auto& input : inputs) taken.push_back(canonical(input));
  for (const auto& file : outputs) {
    if (std::find(taken.begin(), taken.end(), canonical(file)) != taken.end())
      throw Error(Exit::usage, file.string() + ": is another output or an input of this command as well, expected a file of its own");
    taken.push_back(canonical(file));
  }
}

void require_distinct(const ImageFiles& files, const std::optional<std::filesystem::path>& checkpoint,
                      const std::vector<std::filesystem::path>& inputs) {
  std::vector<std::filesystem::path> outputs;
  for (const auto& file : {files.exr, files.png, checkpoint})
    if (file) outputs.push_back(*file);
  require_distinct(outputs, inputs);
}

void attempt_all(const std::vector<std::function<void()>>& attempts) {
  std::exception_ptr failure;
  std::string messages;
  for (const auto& attempt : attempts) {
    try {
      attempt();
    } catch (const std::exception& error) {
      messages += (failure ? "; " : "") + std::string(error.what());
      failure = failure ? std::make_exception_ptr(Error(Exit::render_failed, messages)) : std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

namespace {

void write_exr_image(const std::filesystem::path& path, const Checkpoint& checkpoint, const RunFigures& run) {
  const Film& film = checkpoint.film;
  const WorldFilm& window = checkpoint.head.film;
  Figures figures;
  figures.ranges = checkpoint.ranges;
  figures.rejected = rejected_samples(film);
  figures.rays = film.rays;
  figures.estimated_error = image_error(film);
  if (film.replicas >= 2) figures.standard_error_unit = standard_error_unit(film);
  figures.stopped = run.stopped;
  figures.seconds = run.seconds;
  write_exr(path, {window.width, window.height, window.crop_x, window.crop_y, window.crop_width, window.crop_height},
            parts_of(film, window.pixel_format, checkpoint.head.moment_name, checkpoint.layers),
            header_attributes(checkpoint.head.attributes, figures, reproducible_date()));
}

}  // namespace

void write_images(const ImageFiles& files, const Checkpoint& checkpoint, const RunFigures& run) {
  attempt_all({[&] { if (files.exr) write_exr_image(*files.exr, checkpoint, run); },
               [&] { if (files.png) write_png(*files.png, checkpoint.film.width, checkpoint.film.height, rgb_of(checkpoint.film)); }});
}

void print_files(const ImageFiles& files) {
  for (const auto& written : {files.exr, files.png})
    if (written) std::cout << written->string() << "\n";
}

std::string rejection_warning(std::uint64_t rejected) {
  return rejected == 0 ? ""
                       : std::to_string(rejected) + " samples were not finite, negative or too large and are left out";
}

}  // namespace oclair
