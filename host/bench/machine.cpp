#include "machine.h"

#include <sched.h>
#include <stdlib.h>

#include <cstdio>
#include <fstream>

namespace oclair::bench {

std::string cpu_model() {
  std::string model = "unknown CPU";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(core_count()) + " cores";
}

unsigned core_count() {
  cpu_set_t allowed;
  return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? static_cast<unsigned>(CPU_COUNT(&allowed)) : 1u;
}

std::string load_average() {
  double load[1] = {-1.0};
  if (getloadavg(load, 1) != 1) return "unknown";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", load[0]);
  return text;
}

void use_one_core() {
  setenv("POCL_MAX_PTHREAD_COUNT", "1", 1);
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  sched_setaffinity(0, sizeof one, &one);
}

}  // namespace oclair::bench
