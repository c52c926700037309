// <sensor>: perspective, thinlens, orthographic; with its <film>, <rfilter> and <sampler>.
#pragma once

#include <optional>

#include "document.h"
#include "world.h"

namespace oclair {

// Fills in the world's camera, film, samples per pixel and seed; `film_size` stands for the film's own. Throws
// Error(Exit::scene), or Error(Exit::usage) if there is a `film_size` and the film has a crop window.
void read_sensor(Document& document, std::uint32_t element, const std::optional<glm::uvec2>& film_size, World& world);

}  // namespace oclair
