#include "table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <nlohmann/json.hpp>

#include "../error.h"

namespace oclair::tune {
namespace {

using Json = nlohmann::ordered_json;

std::string formatted(const char* format, int digits, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, digits, value);
  return text;
}

std::string interval(const Interval& i, int digits = 3) {
  return number(i.estimate, digits) + " (" + number(i.low, digits) + "-" + number(i.high, digits) + ")";
}

Json json_of(const Interval& i) { return {{"estimate", i.estimate}, {"low", i.low}, {"high", i.high}}; }

Json json_of(const std::vector<CurvePoint>& curve) {
  Json points = Json::array();
  for (const CurvePoint& point : curve) points.push_back({{"samples", point.samples}, {"seconds", point.seconds}, {"error", point.error}});
  return points;
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

double root(double square) { return std::sqrt(std::max(0.0, square)); }

Json json_of(const Row& row) {
  const Estimates& e = row.estimates;
  Json settings = Json::object();
  for (const Choice& choice : choices())
    if (const std::string value = choice.get(row.choices); !value.empty()) settings[choice.name] = value;
  constexpr const char* effects[] = {"none", "noise", "bias"};
  return {{"name", row.name},
          {"settings", settings},
          {"effect", effects[static_cast<int>(row.effect)]},
          {"sameBits", e.same},
          {"speed", json_of(e.speed)},
          {"bias", json_of(e.bias)},
          {"biasBound", e.bias_bound},
          {"squaredBias", json_of(e.squared_bias)},
          {"rootMeanSquareBias", root(e.squared_bias.estimate)},
          {"variance", json_of(e.variance)},
          {"replicaVariance", e.replica_variance},
          {"replicaSeconds", e.replica_seconds},
          {"secondsToError", json_of(row.seconds)},
          {"gain", json_of(row.gain)},
          {"accurateEnough", row.accurate_enough},
          {"onFront", row.on_front},
          {"combination", row.combination},
          {"slope", json_of(slope(row.curve))},
          {"curve", json_of(row.curve)}};
}

}  // namespace

std::string percent(double share, int digits) { return formatted("%+.*f %%", digits, 100.0 * share); }

std::string number(double value, int digits) {
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return formatted("%.*g", digits, value);
}

std::string bias_text(const Row& row) {
  const Estimates& e = row.estimates;
  if (e.same) return row.effect == Effect::bias ? "none seen: the same bits" : "none: the same bits";
  std::string text = percent(e.bias.low) + " to " + percent(e.bias.high);
  if (e.bias.contains(0.0)) text += ", below " + formatted("%.*f %%", 2, 100.0 * e.bias_bound);
  if (row.effect == Effect::none) return text + "; EXPECTED THE SAME BITS";
  if (row.effect == Effect::noise) text += e.bias.contains(0.0) ? ", none by construction" : "; EXPECTED NONE";
  return text;
}

void print_table(const Result& result, std::ostream& out) {
  out << one_line(result.scene) << ", " << result.width << "x" << result.height << " pixels, " << result.request.replicas << " replicas of "
      << REPLICA_SAMPLES << " samples; to a relative error of " << number(result.request.error) << "; all intervals together hold with "
      << number(100.0 * result.request.confidence) << " %\n\n";
  std::size_t width = 10;
  for (const Row& row : result.rows) width = std::max(width, row.name.size() + 2);
  const auto line = [&](const std::string& mark, const std::string& name, const std::string& gain, const std::string& speed,
                        const std::string& variance, const std::string& pixels, const std::string& bias) {
    out << std::left << std::setw(2) << mark << std::setw(static_cast<int>(width)) << name << std::setw(21) << gain << " " << std::setw(21) << speed << " "
        << std::setw(21) << variance << " " << std::setw(10) << pixels << bias << "\n";
  };
  line("", "setting", "gain", "speed", "variance", "pixels", "bias of the mean");
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Row& row = result.rows[i];
    const Estimates& e = row.estimates;
    line(result.recommended == i ? ">" : row.on_front ? "*" : "", row.name, interval(row.gain), interval(e.speed),
         e.same ? "1" : interval(e.variance), has_bias(row) ? formatted("%.*f %%", 2, 100.0 * root(e.squared_bias.estimate)) : "0",
         bias_text(row));
  }
  line("", "accurate", "1", "1", "1", "0", "0");
  out << "\n> recommended; * nothing is both sooner and less biased. gain: time to the error, the accurate setting's over this one's;\n"
         "speed: of time for a sample; variance: of a sample, this one's over the accurate one's; pixels: root mean square of the relative bias.\n";
  if (const std::size_t least = values_for_median(result.interval_confidence); result.request.replicas < least)
    out << "too few replicas for an interval of the speed: expected --replicas " << least << " or more\n";
  for (const std::string& name : result.not_measured) out << "not measured: " << name << "\n";
}

std::string advice(const Result& result) {
  if (!result.recommended)
    return std::string("recommended: the accurate setting; nothing ") + (result.not_measured.empty() ? "" : "of what was measured ") +
           "is surely sooner at an error of " + number(result.request.error);
  const Row& row = result.rows[*result.recommended];
  return "recommended: " + row.name + ", " + number(row.gain.estimate) + " times as soon at an error of " + number(result.request.error) +
         " (at least " + number(row.gain.low) + " times), bias " + bias_text(row);
}

std::string json_of(const Result& result) {
  const Request& request = result.request;
  Json json = {{"program", "oclair " OCLAIR_VERSION}, {"scene", result.scene},      {"sceneHash", result.scene_hash},
               {"device", result.device},             {"driver", result.driver},    {"width", result.width},
               {"height", result.height},             {"replicas", request.replicas}, {"samplesOfReplica", REPLICA_SAMPLES},
               {"error", request.error},              {"confidence", request.confidence}, {"rejectedSamples", result.rejected},
               {"interrupted", result.interrupted},
               {"seconds", result.wall_seconds}};
  json["accurate"] = {{"replicaVariance", result.replica_variance},
                      {"replicaSeconds", result.replica_seconds},
                      {"secondsToError", result.seconds},
                      {"slope", json_of(slope(result.curve))},
                      {"curve", json_of(result.curve)}};
  json["rows"] = Json::array();
  for (const Row& row : result.rows) json["rows"].push_back(json_of(row));
  json["notMeasured"] = result.not_measured;
  json["recommended"] = result.recommended ? Json(result.rows[*result.recommended].name) : Json(nullptr);
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

SettingsFile settings_of(const Result& result) {
  SettingsFile file;
  file.program = "oclair " OCLAIR_VERSION;
  file.scene = result.scene;
  file.scene_hash = result.scene_hash;
  if (!result.recommended) return file;
  const Row& row = result.rows[*result.recommended];
  const Estimates& e = row.estimates;
  file.choices = row.choices;
  const auto say = [&](const char* name, double value) { file.measured.emplace_back(name, formatted("%.*g", 6, value)); };
  say("bias", e.bias.estimate);
  say("biasBound", e.bias_bound);
  say("rootMeanSquareBias", has_bias(row) ? root(e.squared_bias.estimate) : 0.0);
  say("confidence", result.request.confidence);
  say("error", result.request.error);
  say("speed", e.speed.estimate);
  say("variance", e.variance.estimate);
  say("timeToEqualError", 1.0 / row.gain.estimate);
  return file;
}

}  // namespace oclair::tune
