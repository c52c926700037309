// What the program is doing, phase by phase, for a person who waits. On a terminal the line of the running phase is
// rewritten in place, with a bar where the amount of work is known; anywhere else each phase is one line.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>

namespace oclair {

double steady_seconds();

class Progress {
 public:
  Progress(std::ostream& out, bool is_terminal, std::function<double()> clock = steady_seconds);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // leaves an unfinished phase without its time, at the end of its line

  void begin(const std::string& phase);  // ends the phase before it
  void samples(std::uint64_t done, std::uint64_t total);
  void end();  // does nothing between phases

 private:
  void show(const std::string& details);
  std::string rate() const;

  std::ostream& out_;
  bool is_terminal_;
  std::function<double()> clock_;
  std::string phase_;  // empty: none
  double begun_ = 0, shown_ = 0;
  std::uint64_t done_ = 0;
};

// 12.3 s, 4:05 min, 1:02:03 h
std::string format_seconds(double seconds);

}  // namespace oclair
