#include "render_loop.h"

#include "../error.h"
#include "../film.h"
#include "../layers.h"
#include "../schedule.h"
#include "../signals.h"

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
    warn_of_viewer();
  }

  Stop run() {
    try {
      return run_until_told();
    } catch (const Error& error) {
      if (error.exit != Exit::device) save();
      throw;
    } catch (const std::exception&) {
      save();
      throw;
    }
  }

 private:
  Stop run_until_told() {
    if (monitor_ && renderer_.samples > 0) monitor_->add(film());
    const Stop stop = run_until_stopped();
    show();
    if (monitor_ && stop != Stop::error) progress_.warning("the error is not certified to be below its limit: " + monitor_->why_not());
    return stop;
  }

  Stop run_until_stopped() {
    for (;;) {
      if (renderer_.samples >= limits_.samples) return Stop::samples;
      if (stop_requested()) return Stop::signal;
      const unsigned samples = schedule_.next_pass(renderer_.samples);
      if (samples == 0) return Stop::time;
      pass(samples);
      if (monitor_ && renderer_.samples % REPLICA_SAMPLES == 0) {
        monitor_->add(film());
        if (monitor_->certified()) return Stop::error;
        warn_of_unknown_pixels();
      }
      if (renderer_.samples < limits_.samples) write_what_is_due();  // after the last pass all is written anyway
    }
  }

  const Film& film() {
    if (!film_is_current_) take_film(renderer_, state_);
    film_is_current_ = true;
    return state_.film;
  }

  void pass(unsigned samples) {
    const double pixels = static_cast<double>(renderer_.settings.crop_width) * renderer_.settings.crop_height;
    const auto in_film = [&](double per_pixel) { return static_cast<std::uint64_t>(per_pixel * pixels); };
    return_film(renderer_, state_.film);
    film_is_current_ = false;
    film_is_whole_ = false;
    render_pass(renderer_, samples, [&](double share) {
      const double done = static_cast<double>(renderer_.samples) + share * samples;
      progress_.samples(in_film(done), limits_.open ? std::nullopt : std::optional(in_film(static_cast<double>(limits_.samples))),
                        {rays_so_far(), monitor_ ? monitor_->estimate() : std::nullopt, seconds_left(done)});
    });
    film_is_whole_ = true;
    schedule_.pass_ended(samples);
  }

  // Read back from the device: only for an event that is shown.
  std::optional<std::uint64_t> rays_so_far() const {
    return progress_.shows_samples() ? std::optional(ray_count(renderer_) - rays_before_) : std::nullopt;
  }

  // Until the time is up or the error reached, whichever is sooner; the number of samples is the progress's own business.
  std::optional<double> seconds_left(double done) {
    std::optional<double> seconds = schedule_.seconds_left();
    const double taken = done - samples_before_, elapsed = steady_seconds() - begun_;
    if (monitor_ && taken > 0.0)
      if (const auto expected = monitor_->samples_expected()) {
        const double by_error = std::max(0.0, static_cast<double>(*expected) - done) * elapsed / taken;
        seconds = std::min(by_error, seconds.value_or(by_error));
      }
    return seconds;
  }

  // At once: without another limit the render would go on for ever.
  void warn_of_unknown_pixels() {
    if (warned_of_unknown_pixels_ || monitor_->unknown_pixels() == 0) return;
    warned_of_unknown_pixels_ = true;
    progress_.warning("the error will not be certified: " + monitor_->why_not());
  }

  void warn_of_viewer() {
    if (!way_.viewer) return;
    if (const auto warning = way_.viewer->take_warning()) progress_.warning(*warning);
  }

  void write_what_is_due() {
    const bool asked = take_write_request();
    const bool due = schedule_.picture_due();
    if (way_.write_picture && (asked || due)) {
      const double begun = steady_seconds();
      attempt(way_.write_picture);
      if (due) schedule_.picture_written(steady_seconds() - begun);
    }
    if (way_.write_checkpoint && (asked || schedule_.checkpoint_due())) {
      const double begun = steady_seconds();
      attempt(way_.write_checkpoint);
      schedule_.checkpoint_written(steady_seconds() - begun);
    }
    if (steady_seconds() - viewed_ >= viewer_interval) show();
  }

  void show() {
    if (!way_.viewer || !way_.viewer->connected()) return;
    way_.viewer->show("oclair", film().width, film().height, rgb_of(film()));
    warn_of_viewer();
    viewed_ = steady_seconds();
  }

  // What has been rendered is not lost. A pass that was not ended has left some pixels with more samples than others.
  void save() {
    if (film_is_whole_ && renderer_.samples > 0 && way_.write_checkpoint) attempt(way_.write_checkpoint);
  }

  void attempt(const std::function<void(const Checkpoint&)>& write) {
    film();
    try {
      write(state_);
    } catch (const std::exception& error) {  // memory that is not there is no reason to lose the film
      progress_.warning(error.what());
    }
  }

  const Limits& limits_;
  Renderer& renderer_;
  Checkpoint& state_;
  const OnTheWay& way_;
  Progress& progress_;
  Schedule schedule_;
  ErrorMonitor* const monitor_ = limits_.error;
  const std::uint64_t rays_before_ = ray_count(renderer_);
  const double samples_before_ = static_cast<double>(renderer_.samples), begun_ = steady_seconds();
  bool film_is_current_ = false;  // state_ has it
  bool film_is_whole_ = true;     // all its pixels have the same samples
  bool warned_of_unknown_pixels_ = false;
  double viewed_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::string_view name_of(Stop stop) {
  constexpr std::string_view names[] = {"samples", "time", "error", "signal"};
  return names[static_cast<int>(stop)];
}

void take_film(Renderer& renderer, Checkpoint& state) {
  take_film(renderer, state.film);
  state.ranges = {{renderer.first_sample, renderer.samples}};
}

Stop render_until(const Limits& limits, Renderer& renderer, Checkpoint& state, const OnTheWay& way, Progress& progress,
                  double program_started) {
  return Loop(limits, renderer, state, way, progress, program_started).run();
}

}  // namespace oclair
