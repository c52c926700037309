// When a render writes the picture on the way and its checkpoint, how large its next pass is, and when its time is up. Only
// differences of a steady clock count: what the calendar does is of no consequence.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "progress.h"

namespace oclair {

// "90s", "2m", "1.5h", or seconds without a unit; more than 0 and at most 1e9 seconds. Anything else gives nothing.
std::optional<double> parse_duration(std::string_view text);

class Schedule {
 public:
  struct Limits {
    std::uint64_t samples;                   // per pixel
    std::optional<double> seconds;           // from `started` on
    std::optional<double> checkpoint_every;  // seconds
  };

  // `started`: what the clock said when the program started, so that the limit covers all phases; nothing: now.
  explicit Schedule(const Limits& limits, std::function<double()> clock = steady_seconds,
                    std::optional<double> started = std::nullopt);

  // Samples per pixel of the pass that begins now, when `done` are there: 1, 1, 2, 4, ... up to 16, and such that a run of
  // passes ends at each multiple of 16. Never more than are wanted; as measured by the last pass not beyond the time left nor
  // beyond the next picture or checkpoint, but at least 1. 0: a limit is reached.
  unsigned next_pass(std::uint64_t done);
  void pass_ended(unsigned samples);

  bool picture_due();     // first 2 s after the start of this schedule; the interval doubles with each picture
  bool checkpoint_due();  // so many seconds after the one before
  // The last writing of each kind is taken off the time left, as both will be written once more at the end.
  void picture_written(double seconds_taken);
  void checkpoint_written(double seconds_taken);

  bool out_of_time();  // less is left than half a sample takes; never before the first pass has ended
  std::optional<double> seconds_left();  // until the time limit, at least 0

 private:
  double now();

  Limits limits_;
  std::function<double()> clock_;
  double read_, now_ = 0;  // the clock's last value; seconds since this schedule was made
  double deadline_ = 0;    // all times are seconds since then
  double next_picture_, picture_interval_;
  double next_checkpoint_ = 0;
  double picture_seconds_ = 0, checkpoint_seconds_ = 0;
  double pass_begun_ = 0;
  std::optional<double> seconds_per_sample_;
  std::uint64_t taken_ = 0;  // samples per pixel, by this schedule
};

}  // namespace oclair
