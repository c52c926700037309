#include "schedule.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "number.h"

namespace oclair {
namespace {

constexpr double first_picture = 2.0;  // seconds
// A pass of more than one sample does not take longer: a signal, which waits for the pass to end, is answered soon.
constexpr double longest_pass = 5.0;  // seconds
constexpr std::uint64_t largest_pass = 16;  // samples per pixel

}  // namespace

std::optional<double> parse_duration(std::string_view text) {
  double unit = 1.0;
  if (!text.empty()) {
    const char last = text.back();
    if (last == 'm') unit = 60.0;
    if (last == 'h') unit = 3600.0;
    if (last == 's' || last == 'm' || last == 'h') text.remove_suffix(1);
  }
  const std::optional<double> number = parse_number(text);
  if (!number || !(*number * unit > 0.0) || *number * unit > 1e9) return std::nullopt;
  return *number * unit;
}

Schedule::Schedule(const Limits& limits, std::function<double()> clock, std::optional<double> started)
    : limits_(limits), clock_(std::move(clock)), read_(clock_()), next_picture_(first_picture), picture_interval_(first_picture) {
  constexpr double never = std::numeric_limits<double>::infinity();
  deadline_ = limits_.seconds ? *limits_.seconds - std::max(0.0, read_ - started.value_or(read_)) : never;
  next_checkpoint_ = limits_.checkpoint_every.value_or(never);
}

// A clock that is set back (no steady clock is) costs what it went back, and nothing else.
double Schedule::now() {
  const double read = clock_();
  now_ += std::max(0.0, read - read_);
  read_ = read;
  return now_;
}

unsigned Schedule::next_pass(std::uint64_t done) {
  pass_begun_ = now();
  if (done >= limits_.samples || out_of_time()) return 0;
  std::uint64_t samples = std::clamp<std::uint64_t>(taken_, 1, largest_pass);
  samples = std::min({samples, largest_pass - done % largest_pass, limits_.samples - done});
  if (seconds_per_sample_) {
    const double writing = picture_seconds_ + checkpoint_seconds_;
    const double free = std::min({longest_pass, deadline_ - writing - now_, next_picture_ - now_, next_checkpoint_ - now_});
    if (free < static_cast<double>(samples) * *seconds_per_sample_)
      samples = static_cast<std::uint64_t>(std::max(1.0, free / *seconds_per_sample_));
  }
  return static_cast<unsigned>(samples);
}

void Schedule::pass_ended(unsigned samples) {
  taken_ += samples;
  seconds_per_sample_ = (now() - pass_begun_) / std::max(1u, samples);
}

bool Schedule::picture_due() { return now() >= next_picture_; }
bool Schedule::checkpoint_due() { return now() >= next_checkpoint_; }

void Schedule::picture_written(double seconds_taken) {
  picture_seconds_ = seconds_taken;
  picture_interval_ *= 2.0;
  next_picture_ = now() + picture_interval_;
}

void Schedule::checkpoint_written(double seconds_taken) {
  checkpoint_seconds_ = seconds_taken;
  if (limits_.checkpoint_every) next_checkpoint_ = now() + *limits_.checkpoint_every;
}

bool Schedule::out_of_time() {
  const double writing = picture_seconds_ + checkpoint_seconds_;
  return seconds_per_sample_ && deadline_ - writing - now() < 0.5 * *seconds_per_sample_;
}

std::optional<double> Schedule::seconds_left() {
  if (!limits_.seconds) return std::nullopt;
  return std::max(0.0, deadline_ - now());
}

}  // namespace oclair
