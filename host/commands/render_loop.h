// The passes of a render until a limit is reached, and what is written on the way.
#pragma once

#include <functional>
#include <limits>
#include <memory>

#include "../checkpoint.h"
#include "../progress.h"
#include "../render.h"
#include "../stopping.h"
#include "../tev.h"

namespace oclair {

// Which limit ended the passes.
enum class Stop { samples, time, error, signal };

std::string_view name_of(Stop stop);

// When it is enough: whichever comes first.
struct Limits {
  std::uint64_t samples = 0;            // per pixel, those of an earlier run included
  bool open = false;                    // they are only what can be counted: another limit is to end the render
  std::optional<double> seconds;        // since the program started
  ErrorMonitor* error = nullptr;        // of the image: until it certifies the film
};

// What is done with the film on the way; each may be absent.
struct OnTheWay {
  std::function<void(const Checkpoint&)> write_picture, write_checkpoint;
  double checkpoint_every = 30.0;  // seconds
  TevClient* viewer = nullptr;
};

// Brings `state` up to the renderer: its film, which it has until the next pass, and which samples that holds.
void take_film(Renderer& renderer, Checkpoint& state);

// Renders on from where the renderer stands. A file that cannot be written on the way is warned of, and tried again the next time.
// Before an exception between two passes goes on, unless the device is at fault, the checkpoint is written.
// The whole film is read back only where something is made of it; `state` is then as of that pass. It may hold it at the end.
Stop render_until(const Limits& limits, Renderer& renderer, Checkpoint& state, const OnTheWay& way, Progress& progress,
                  double program_started);

}  // namespace oclair
