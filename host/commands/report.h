// What info says of scenes and of images, and how.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>

#include "../film_plan.h"
#include "../world.h"

namespace oclair {

void print_warnings(const World& world, std::ostream& log);

// Begins a line of the standard output: a name, and the column where its value begins.
std::ostream& row(const std::string& name);

// "1.5 MiB": for memory.
std::string format_bytes(std::size_t bytes);

// "46.0 GiB in files beside the checkpoint, 16 bands of 1024 rows, one at a time, on the device": the film.
std::string film_text(const FilmPlan& film);

}  // namespace oclair
