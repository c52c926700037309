#include "output.h"

#include <iostream>

#include "../film.h"

namespace oclair {

void require_writable(const ImageFiles& files) {
  if (files.exr) require_writable(*files.exr);
  if (files.png) require_writable(*files.png);
}

void write_images(const ImageFiles& files, const Checkpoint& checkpoint, const RunFigures& run) {
  const Film& film = checkpoint.film;
  if (files.exr) {
    const WorldFilm& window = checkpoint.head.film;
    Figures figures;
    figures.ranges = checkpoint.ranges;
    figures.rejected = rejected_samples(film);
    figures.rays = film.rays;
    figures.estimated_error = image_error(film);
    figures.stopped = run.stopped;
    figures.seconds = run.seconds;
    write_exr(*files.exr, {window.width, window.height, window.crop_x, window.crop_y, window.crop_width, window.crop_height},
              parts_of(film, window.pixel_format, checkpoint.head.moment_name, checkpoint.layers),
              header_attributes(checkpoint.head.attributes, figures, reproducible_date()));
  }
  if (files.png) {
    const std::vector<float> rgb = rgb_of(film);
    const std::span<const float> values(rgb);
    write_png(*files.png, film.width, film.height, {{{values, 3}, {values.subspan(1), 3}, {values.subspan(2), 3}}});
  }
}

void print_files(const ImageFiles& files) {
  for (const auto& written : {files.exr, files.png})
    if (written) std::cout << written->string() << "\n";
}

std::string film_warning(const Film& film) {
  const std::uint64_t rejected = rejected_samples(film);
  return rejected == 0 ? ""
                       : std::to_string(rejected) + " samples were not finite, negative or too large and are left out";
}

}  // namespace oclair
