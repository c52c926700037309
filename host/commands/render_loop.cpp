#include "render_loop.h"

#include "../error.h"
#include "../film.h"
#include "../layers.h"
#include "../schedule.h"
#include "../signals.h"
#include "../stopping.h"

namespace oclair {
namespace {

constexpr double viewer_interval = 1.0;  // seconds between two pictures in a viewer, at least

class Loop {
 public:
  Loop(const Limits& limits, Renderer& renderer, Checkpoint& state, const OnTheWay& way, Progress& progress, double program_started)
      : limits_(limits),
        renderer_(renderer),
        state_(state),
        way_(way),
        progress_(progress),
        schedule_({limits.samples, limits.seconds,
                   way.write_checkpoint ? std::optional(way.checkpoint_every) : std::nullopt},
                  steady_seconds, program_started) {
    if (limits.error) {
      monitor_.emplace(*limits.error, limits.confidence);
      if (renderer.samples > 0) monitor_->add(film());
    }
  }

  Stop run() {
    while (!stop_requested()) {
      const unsigned samples = schedule_.next_pass(renderer_.samples);
      if (samples == 0) return renderer_.samples >= limits_.samples ? Stop::samples : Stop::time;
      pass(samples);
      if (monitor_ && renderer_.samples % REPLICA_SAMPLES == 0) {
        monitor_->add(film());
        if (monitor_->certified()) return Stop::error;
      }
      write_what_is_due();
    }
    return Stop::signal;
  }

 private:
  const Film& film() {
    if (!film_is_current_) take_film(renderer_, state_);
    film_is_current_ = true;
    return state_.film;
  }

  void pass(unsigned samples) {
    const double pixels = static_cast<double>(renderer_.settings.crop_width) * renderer_.settings.crop_height;
    const auto in_film = [&](double per_pixel) { return static_cast<std::uint64_t>(per_pixel * pixels); };
    const bool open = limits_.samples == MAX_SAMPLES - renderer_.first_sample;  // other limits end it
    render_pass(renderer_, samples, [&](double share) {
      const double done = static_cast<double>(renderer_.samples) + share * samples;
      progress_.samples(in_film(done), open ? std::nullopt : std::optional(in_film(static_cast<double>(limits_.samples))),
                        {ray_count(renderer_) - rays_before_, monitor_ ? monitor_->estimate() : std::nullopt, schedule_.seconds_left()});
    });
    schedule_.pass_ended(samples);
    film_is_current_ = false;
  }

  void write_what_is_due() {
    const bool asked = take_write_request();
    if (way_.write_picture && (asked || schedule_.picture_due())) {
      const double begun = steady_seconds();
      attempt(way_.write_picture);
      schedule_.picture_written(steady_seconds() - begun);
    }
    if (way_.write_checkpoint && (asked || schedule_.checkpoint_due())) {
      const double begun = steady_seconds();
      attempt(way_.write_checkpoint);
      schedule_.checkpoint_written(steady_seconds() - begun);
    }
    if (way_.viewer && way_.viewer->connected() && steady_seconds() - viewed_ >= viewer_interval) {
      way_.viewer->show("oclair", film().width, film().height, rgb_of(film()));
      if (const auto warning = way_.viewer->take_warning()) progress_.warning(*warning);
      viewed_ = steady_seconds();
    }
  }

  void attempt(const std::function<void(const Checkpoint&)>& write) {
    film();
    try {
      write(state_);
    } catch (const Error& error) {
      progress_.warning(error.what());
    }
  }

  const Limits& limits_;
  Renderer& renderer_;
  Checkpoint& state_;
  const OnTheWay& way_;
  Progress& progress_;
  Schedule schedule_;
  std::optional<ErrorMonitor> monitor_;
  const std::uint64_t rays_before_ = ray_count(renderer_);
  bool film_is_current_ = false;
  double viewed_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::string_view name_of(Stop stop) {
  constexpr std::string_view names[] = {"samples", "time", "error", "signal"};
  return names[static_cast<int>(stop)];
}

void take_film(const Renderer& renderer, Checkpoint& state) {
  state.film = read_film(renderer);
  state.ranges = {{renderer.first_sample, renderer.samples}};
}

Stop render_until(const Limits& limits, Renderer& renderer, Checkpoint& state, const OnTheWay& way, Progress& progress,
                  double program_started) {
  return Loop(limits, renderer, state, way, progress, program_started).run();
}

}  // namespace oclair
