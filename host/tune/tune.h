// What each option that trades speed for accuracy buys and costs on one scene and device: `oclair tune`, docs/tune.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "../choices.h"
#include "../reader.h"
#include "estimates.h"

namespace oclair::tune {

struct Request {
  std::filesystem::path scene;
  Definitions definitions;
  std::string device;
  double budget = 120.0;    // seconds of wall time, from `started`
  double error = 0.02;      // relative error that the renders are for
  double confidence = 0.95; // with which all intervals hold together
  std::optional<glm::uvec2> size;
  unsigned replicas = 16;   // of each setting; at least 4
  std::function<void(const World&)> inspect = [](const World&) {};  // called with the scene before its first picture; what it throws ends all
};

struct Row {
  std::string name;  // text_of(choices)
  Choices choices;
  Effect effect = Effect::none;  // the strongest of its choices
  Estimates estimates;
  std::optional<double> seconds;  // to the error asked for, of the picture measured; nothing: its bias is too large
  Interval gain{};                // accurate seconds to that error over these
  bool accurate_enough = false;   // the bias is below the error, shown with the confidence or known by construction
  bool on_front = false;          // no row is both sooner and less biased
  bool combination = false;       // of the best values of several options
  std::vector<CurvePoint> curve;
  Picture difference;             // mean over the replicas, minus the accurate one
};

struct Result {
  std::string scene, scene_hash, device, driver;
  unsigned width = 0, height = 0;
  Request request;
  Picture picture;                // the reference: accurate, with random numbers of its own
  double replica_seconds = 0.0, replica_variance = 0.0, seconds = 0.0;  // of the accurate setting, as in Row
  std::vector<CurvePoint> curve;
  std::vector<Row> rows;          // by gain, the largest first
  std::vector<std::string> not_measured;  // names of those for which there was no time
  std::optional<std::size_t> recommended; // row; nothing: the accurate setting
  std::uint64_t rejected = 0;             // samples of the accurate pictures, as in an image's header
  bool interrupted = false;
  double interval_confidence = 0.0;       // of each interval, so that all hold together as asked for
  double wall_seconds = 0.0;
};

// Told before each setting: how many of how many are done, and which comes.
using Tell = std::function<void(std::size_t done, std::size_t of, const std::string& name)>;

// Throws Error as reading and rendering do, Error(Exit::device) if the pictures take more than half of the host's memory, and
// Error(Exit::stopped) if the budget is too short to measure one setting or a signal came before the first picture.
Result tune(const Request& request, const Tell& tell);

// What can be of use to the scene, one option changed at a time. mean: of the picture's values, for clamping.
std::vector<Choices> candidates(const Scene& scene, int bvh_width, double mean);

// Whether the setting changes what pictures tend to: because it can and changes samples, or because it should not and is seen to.
bool has_bias(const Row& row);

// Figures of a row that follow from its estimates: gain, seconds, accurate_enough.
void judge(Row& row, double error);

// Sorts the rows, marks the front, and says which one is best.
void rank(Result& result);

}  // namespace oclair::tune
