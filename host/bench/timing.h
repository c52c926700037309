// Contenders measured in turn, so that what the machine does meanwhile meets all of them; ratios are formed within a round.
#pragma once

#include <functional>
#include <vector>

namespace oclair::bench {

struct Contender {
  std::function<void()> prepare;  // before each run, not timed; may be empty
  std::function<double()> run;    // returns its seconds: `timed` or `timed_on_cpu` of what it does
};

struct Spread {
  double median, least, most;
};

Spread spread_of(std::vector<double> values);

using Seconds = std::vector<double>;  // a round each

// One warm-up, then `rounds` times all contenders, the order reversed in every second round. Seconds of each contender.
std::vector<Seconds> measure(const std::vector<Contender>& contenders, unsigned rounds);

// Of a's seconds to b's, round by round.
Spread ratio_of(const Seconds& a, const Seconds& b);

double seconds_of(const std::function<void()>& run);
std::function<double()> timed(std::function<void()> run);

// Processor time of all threads of this process: what others do on the machine costs nothing but cache.
std::function<double()> timed_on_cpu(std::function<void()> run);

}  // namespace oclair::bench
