// <integrator>: path, direct, moment.
#pragma once

#include "document.h"
#include "world.h"

namespace oclair {

// Fills in the world's integrator. Throws Error(Exit::scene).
void read_integrator(Document& document, std::uint32_t element, World& world);

}  // namespace oclair
