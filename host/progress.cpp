#include "progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
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

}  // namespace

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Progress::Progress(std::ostream& out, bool is_terminal, std::function<double()> clock)
    : out_(out), is_terminal_(is_terminal), clock_(std::move(clock)) {}

Progress::~Progress() {
  if (!phase_.empty()) out_ << std::endl;
}

void Progress::begin(const std::string& phase) {
  end();
  phase_ = phase;
  begun_ = shown_ = clock_();
  done_ = 0;
  show("");
}

void Progress::samples(std::uint64_t done, std::uint64_t total) {
  done_ = done;
  const double now = clock_();
  if (!is_terminal_ || now - shown_ < 0.1) return;
  shown_ = now;
  const double share = total > 0 ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total)) : 1.0;
  const int width = 24, full = static_cast<int>(share * width);
  std::string details = "[" + std::string(full, '#') + std::string(width - full, '.') + "]";
  details += format(" %3d %%", static_cast<int>(100 * share)) + rate();
  if (share > 0) details += "  " + format_seconds((now - begun_) * (1 / share - 1)) + " left";
  show(details);
}

void Progress::end() {
  if (phase_.empty()) return;
  show(format_seconds(clock_() - begun_) + rate());
  out_ << std::endl;
  phase_.clear();
}

// Off a terminal the name is written when the phase begins and the rest of its line when it ends.
void Progress::show(const std::string& details) {
  const bool begins = details.empty();
  if (is_terminal_) out_ << "\r\x1b[K";
  if (is_terminal_ || begins) out_ << format("%-8s", phase_.c_str());
  out_ << details << std::flush;
}

std::string Progress::rate() const {
  const double seconds = clock_() - begun_;
  if (done_ == 0 || seconds <= 0) return "";
  const double per_second = static_cast<double>(done_) / seconds;
  const int thousands = std::clamp(static_cast<int>(std::log10(std::max(1.0, per_second)) / 3), 0, 4);
  const char* const prefixes[] = {"", "k", "M", "G", "T"};
  return format("  %.2f %ssamples/s", per_second / std::pow(1000.0, thousands), prefixes[thousands]);
}

std::string format_seconds(double seconds) {
  if (seconds < 59.95) return format("%.1f s", seconds);
  const long long whole = std::llround(seconds);
  if (whole < 3600) return format("%lld:%02lld min", whole / 60, whole % 60);
  return format("%lld:%02lld:%02lld h", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace oclair
