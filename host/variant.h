// The kernels that scenes share. Each scene could have one of its own, and with --kernels exact it has; but each is some seconds of
// compilation when it is first met. What the difference costs in speed: docs/performance.md.
#pragma once

#include <string_view>

#include "../cl/features.h"

namespace oclair {

// Each holds what the one before it holds. A feature stands alone if a kernel has it only for those who ask.
enum class Variant { PLAIN, SURFACES, TEXTURED, FULL, ALONE };

std::string_view name_of(Variant variant);

// The smallest variant that has all features of a scene but those that stand alone.
Variant variant_of(Features scene);

// What the variant is compiled with for a scene: all of its features, and the scene's own that stand alone.
Features variant_features(Variant variant, Features scene);

}  // namespace oclair
