// Where a film lies, and how much of it at a time: planned, told and checked before any of it is taken.
#pragma once

#include <limits>
#include <string>

#include "film_vector.h"
#include "upload.h"

namespace oclair {

// "12 MiB", rounded up: for messages.
std::string mib(std::size_t bytes);

// Half of the host's memory.
std::size_t default_film_memory();

struct FilmLimits {
  std::size_t on_device = std::numeric_limits<std::size_t>::max();  // bytes of film in the device's buffers
  std::size_t in_memory = default_film_memory();                    // bytes of film in the host's memory, those of a device that shares it too
  std::filesystem::path directory = ".";                            // of the files in which a larger one lies
  std::size_t error_bytes = 0, layer_bytes = 0;                     // that a pixel takes on the host beside the film's sums
};

// The film's buffers, which the device fills: pixels, second moments if the scene asks for them, and what the error is made of. A film
// that is too large for the device lies there a band of rows at a time, and as a whole on the host.
struct FilmPlan {
  uint rows = 0;   // of a band: a multiple of TILE_WIDTH, or all; the last band may have fewer
  uint bands = 0;
  std::size_t film = 0, moments = 0, errors = 0;  // bytes for one band
  std::size_t whole = 0;                          // bytes of film on the host, with error_bytes of FilmLimits
  std::size_t layers = 0;                         // bytes of layers, in memory
  FilmDirectory directory{};                      // of the film on the host; null: in memory

  std::size_t band() const { return film + moments + errors; }
};

// As few bands as the limits and the device's memory allow beside the scene; a band has a row of tiles at least. A device that shares
// the host's memory gets a quarter of what the film may take there, or all of the film if both fit.
FilmPlan plan_film(const Device& device, const Scene& scene, const std::vector<BufferPlan>& plan, const FilmLimits& limits = {});

// Throws Error(Exit::device) if a buffer exceeds what the device allocates at once, or all of them its memory, or what lies in the
// host's memory exceeds that.
void check_memory(const Device& device, const std::vector<BufferPlan>& plan, const FilmPlan& film);

}  // namespace oclair
