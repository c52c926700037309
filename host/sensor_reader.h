// <sensor type="perspective"> with its <film>, <rfilter> and <sampler>.
#pragma once

#include "document.h"
#include "world.h"

namespace oclair {

// Fills in the world's camera, film, samples per pixel and seed. Throws Error(Exit::scene).
void read_sensor(Document& document, std::uint32_t element, World& world);

}  // namespace oclair
