// What the program is doing, phase by phase, for a person who waits or for a machine that watches. For a person on a terminal
// the line of the running phase is rewritten in place, with a bar where the amount of work is known; anywhere else each phase
// is one line. For a machine each event is one line of JSON: docs/progressive.md lists them.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

namespace oclair {

double steady_seconds();

// What is known of a running render beside the number of its samples.
struct SampleFigures {
  std::optional<std::uint64_t> rays;   // traced since the phase began
  std::optional<double> error;         // estimated error of the image, as --error counts it
  std::optional<double> seconds_left;  // until a limit that is not a number of samples
};

class Progress {
 public:
  Progress(std::ostream& out, bool is_terminal, std::function<double()> clock = steady_seconds);
  static Progress json(std::ostream& out, std::function<double()> clock = steady_seconds);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // leaves an unfinished phase without its time, at the end of its line; JSON without finish: reason "failed"

  // Ends the phase before it. `samples_before`: those that samples() will count although an earlier run has taken them.
  void begin(const std::string& phase, std::uint64_t samples_before = 0);
  bool shows_samples() const;  // whether samples() would now be seen: figures that cost something may be left out otherwise
  // In all pixels together; `wanted` is absent where no number of samples is the target.
  void samples(std::uint64_t done, std::optional<std::uint64_t> wanted, const SampleFigures& figures = {});
  void end();  // does nothing between phases

  void memory(const std::string& plan, std::uint64_t film_bytes);  // what a render is about to take, between phases
  void wrote_file(const std::string& path);        // a person reads the names on standard output
  void wrote_checkpoint(const std::string& path);  // silent for a person
  void warning(const std::string& message);        // one line; the running phase goes on below it
  void finish(const std::string& reason, int exit_code);  // ends the phase; the last event

 private:
  enum class Face { line, terminal, json };
  Progress(std::ostream& out, Face face, std::function<double()> clock);

  void show(const std::string& details);
  std::string rate() const;
  std::optional<double> samples_per_second() const;
  std::optional<double> seconds_left(std::optional<std::uint64_t> wanted, const SampleFigures& figures) const;

  std::ostream& out_;
  Face face_;
  std::function<double()> clock_;
  double started_;
  std::string phase_;  // empty: none
  double begun_ = 0, shown_ = 0;
  std::uint64_t before_ = 0, done_ = 0;
  bool finished_ = false;
};

// 12.3 s, 4:05 min, 1:02:03 h
std::string format_seconds(double seconds);

}  // namespace oclair
