#include "timing.h"

#include <time.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

namespace oclair::bench {

Spread spread_of(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

double seconds_of(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::function<double()> timed(std::function<void()> run) {
  return [run = std::move(run)] { return seconds_of(run); };
}

std::function<double()> timed_on_cpu(std::function<void()> run) {
  return [run = std::move(run)] {
    const auto now = [] {
      timespec t;
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
      return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double start = now();
    run();
    return now() - start;
  };
}

std::vector<Seconds> measure(const std::vector<Contender>& contenders, unsigned rounds) {
  std::vector<Seconds> seconds(contenders.size());
  for (unsigned round = 0; round <= rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const std::size_t turn = round % 2 ? contenders.size() - 1 - i : i;
      const Contender& contender = contenders[turn];
      if (contender.prepare) contender.prepare();
      const double taken = contender.run();
      if (round > 0) seconds[turn].push_back(taken);
    }
  }
  return seconds;
}

Spread ratio_of(const Seconds& a, const Seconds& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
  return spread_of(ratios);
}

}  // namespace oclair::bench
