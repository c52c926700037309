#include "progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

namespace oclair {
namespace {

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char line[128];
  std::snprintf(line, sizeof line, pattern, values...);
  return line;
}

// Ordered: the event's name stands first in its line, for the eye.
using Event = nlohmann::ordered_json;

// Absent, or not a number that JSON has: null.
template <typename Value>
Event or_null(const std::optional<Value>& value) {
  return value && std::isfinite(static_cast<double>(*value)) ? Event(*value) : Event();
}

// To the millisecond: more digits would say nothing.
std::optional<double> rounded(std::optional<double> seconds) {
  if (seconds) seconds = std::round(*seconds * 1e3) / 1e3;
  return seconds;
}

// One line. A name that is not UTF-8 is written with replacement characters.
void write_event(std::ostream& out, const char* name, double seconds, const Event& details) {
  Event event{{"event", name}, {"seconds", or_null(rounded(seconds))}};
  event.update(details);
  out << event.dump(-1, ' ', false, Event::error_handler_t::replace) << std::endl;
}

}  // namespace

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Progress::Progress(std::ostream& out, Face face, std::function<double()> clock)
    : out_(out), face_(face), clock_(std::move(clock)), started_(clock_()) {}

Progress::Progress(std::ostream& out, bool is_terminal, std::function<double()> clock)
    : Progress(out, is_terminal ? Face::terminal : Face::line, std::move(clock)) {}

Progress Progress::json(std::ostream& out, std::function<double()> clock) { return {out, Face::json, std::move(clock)}; }

Progress::~Progress() {
  if (face_ == Face::json) {
    if (!finished_) write_event(out_, "finish", clock_() - started_, {{"reason", "failed"}, {"exit", nullptr}});
  } else if (!phase_.empty()) {
    out_ << std::endl;
  }
}

void Progress::begin(const std::string& phase, std::uint64_t samples_before) {
  end();
  phase_ = phase;
  begun_ = shown_ = clock_();
  before_ = done_ = samples_before;
  if (face_ == Face::json)
    write_event(out_, "begin", clock_() - started_, {{"phase", phase_}});
  else
    show("");
}

bool Progress::shows_samples() const {
  return face_ != Face::line && clock_() - shown_ >= (face_ == Face::json ? 1.0 : 0.1);
}

void Progress::samples(std::uint64_t done, std::optional<std::uint64_t> wanted, const SampleFigures& figures) {
  done_ = done;
  if (!shows_samples()) return;
  const double now = shown_ = clock_();
  const std::optional<double> left = seconds_left(wanted, figures);
  if (face_ == Face::json) {
    std::optional<double> rays_per_second;
    if (figures.rays) rays_per_second = static_cast<double>(*figures.rays) / (now - begun_);
    write_event(out_, "samples", clock_() - started_, {{"phase", phase_},
                      {"done", done},
                      {"wanted", or_null(wanted)},
                      {"samples_per_second", or_null(samples_per_second())},
                      {"rays_per_second", or_null(rays_per_second)},
                      {"error", or_null(figures.error)},
                      {"seconds_left", or_null(rounded(left))}});
    return;
  }
  std::string details;
  if (wanted) {
    const double share = *wanted > 0 ? std::min(1.0, static_cast<double>(done) / static_cast<double>(*wanted)) : 1.0;
    const int width = 24, full = static_cast<int>(share * width);
    details = "[" + std::string(full, '#') + std::string(width - full, '.') + "]";
    details += format(" %3d %%", static_cast<int>(100 * share));
  }
  details += rate();
  if (figures.error) details += format("  error %.2g", *figures.error);
  if (left) details += "  " + format_seconds(*left) + " left";
  show(details);
}

void Progress::end() {
  if (phase_.empty()) return;
  const double seconds = clock_() - begun_;
  if (face_ == Face::json) {
    Event details{{"phase", phase_}, {"duration", or_null(rounded(seconds))}};
    if (const auto per_second = samples_per_second()) {
      details["done"] = done_;
      details["samples_per_second"] = or_null(per_second);
    }
    write_event(out_, "end", clock_() - started_, details);
  } else {
    show(format_seconds(seconds) + rate());
    out_ << std::endl;
  }
  phase_.clear();
}

void Progress::memory(const std::string& plan, std::uint64_t film_bytes) {
  end();
  if (face_ == Face::json) write_event(out_, "memory", clock_() - started_, {{"film", film_bytes}, {"plan", plan}});
  else out_ << format("%-8s", "memory") << plan << std::endl;
}

void Progress::wrote_file(const std::string& path) {
  if (face_ == Face::json) write_event(out_, "file", clock_() - started_, {{"path", path}});
}

void Progress::wrote_checkpoint(const std::string& path) {
  if (face_ == Face::json) write_event(out_, "checkpoint", clock_() - started_, {{"path", path}});
}

void Progress::warning(const std::string& message) {
  if (face_ == Face::json) {
    write_event(out_, "warning", clock_() - started_, {{"message", message}});
    return;
  }
  if (face_ == Face::terminal && !phase_.empty()) out_ << "\r\x1b[K";
  if (face_ == Face::line && !phase_.empty()) out_ << "\n";
  out_ << "oclair: warning: " << message << std::endl;
  if (!phase_.empty()) show("");
}

void Progress::finish(const std::string& reason, int exit_code) {
  end();
  finished_ = true;
  if (face_ == Face::json)
    write_event(out_, "finish", clock_() - started_, {{"reason", reason}, {"exit", exit_code}});
}

// Off a terminal the name is written when the phase begins and the rest of its line when it ends.
void Progress::show(const std::string& details) {
  const bool begins = details.empty();
  if (face_ == Face::terminal) out_ << "\r\x1b[K";
  if (face_ == Face::terminal || begins) out_ << format("%-8s", phase_.c_str());
  out_ << details << std::flush;
}

std::optional<double> Progress::samples_per_second() const {
  const double seconds = clock_() - begun_;
  if (done_ <= before_ || seconds <= 0) return std::nullopt;
  return static_cast<double>(done_ - before_) / seconds;
}

std::string Progress::rate() const {
  const auto per_second = samples_per_second();
  if (!per_second) return "";
  const int thousands = std::clamp(static_cast<int>(std::log10(std::max(1.0, *per_second)) / 3), 0, 4);
  const char* const prefixes[] = {"", "k", "M", "G", "T"};
  return format("  %.2f %ssamples/s", *per_second / std::pow(1000.0, thousands), prefixes[thousands]);
}

// Of the limits that are known, the one that comes first.
std::optional<double> Progress::seconds_left(std::optional<std::uint64_t> wanted, const SampleFigures& figures) const {
  std::optional<double> left = figures.seconds_left;
  const auto per_second = samples_per_second();
  if (!wanted || !per_second) return left;
  const double rest = static_cast<double>(*wanted - std::min(*wanted, done_)) / *per_second;
  return left ? std::min(*left, rest) : rest;
}

std::string format_seconds(double seconds) {
  if (seconds < 59.95) return format("%.1f s", seconds);
  const long long whole = std::llround(seconds);
  if (whole < 3600) return format("%lld:%02lld min", whole / 60, whole % 60);
  return format("%lld:%02lld:%02lld h", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace oclair
