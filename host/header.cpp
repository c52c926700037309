#include "header.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string_view>

#include "error.h"

namespace oclair {
namespace {

void append_word(std::string& words, const std::string& word) { words += (words.empty() ? "" : " ") + word; }

// YYYY:MM:DD hh:mm:ss, the format of the standard attribute capDate.
std::string date_text(std::int64_t date) {
  const std::time_t seconds = date;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[64];
  return {text, std::strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &parts)};
}

// The fewest digits that give the float back.
std::string shortest(float number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string seconds_text(const std::vector<std::pair<std::string, double>>& phases) {
  std::string all;
  for (const auto& [phase, seconds] : phases) {
    char number[64];
    std::snprintf(number, sizeof number, "%.3f", seconds);
    all += (all.empty() ? "" : ", ") + phase + " " + number;
  }
  return all;
}

std::string quoted(std::string_view argument) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string_view::npos) return std::string(argument);
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::string feature_names(Features features) {
  std::string names;
#define FEATURE_NAME(name, bit, variant, description) \
  if (features & FEATURE_##name) append_word(names, #name);
  FEATURE_LIST(FEATURE_NAME)
#undef FEATURE_NAME
  return names;
}

std::string approximation_names(const Scene& scene) {
  std::string names;
#define APPROXIMATION_NAME(name, bit, description) \
  if (scene.approximations & APPROXIMATION_##name) append_word(names, description);
  APPROXIMATION_LIST(APPROXIMATION_NAME)
#undef APPROXIMATION_NAME
  if (scene.approximations & APPROXIMATION_CLAMP) names.insert(names.find("clamp") + 5, "=" + shortest(scene.settings.largest_sample));
  if (scene.features & FEATURE_OREN_NAYAR_FAST) append_word(names, "oren_nayar=qualitative");
  return names.empty() ? "none" : names;
}

const char* name_of(SamplerKind sampler) { return sampler == SAMPLER_SOBOL ? "sobol" : "independent"; }

const char* arithmetic_name(const Scene& scene) { return scene.double_precision ? "double" : "float"; }

HeaderTexts header_texts(const Origin& origin, const Scene& scene, const Device& device) {
  return {{"software", "oclair " OCLAIR_VERSION},
          {"scene", origin.scene},
          {"sceneHash", origin.scene_hash},
          {"commandLine", origin.command_line},
          {"options", origin.options},
          {"seed", std::to_string(scene.settings.seed)},
          {"sampler", name_of(static_cast<SamplerKind>(scene.settings.sampler))},
          {"features", feature_names(scene.features)},
          {"approximations", approximation_names(scene)},
          {"arithmetic", arithmetic_name(scene)},
          {"device", device.name},
          {"driver", device.platform}};
}

ImageAttributes header_attributes(const HeaderTexts& texts, const Figures& figures, std::optional<std::int64_t> date) {
  ImageAttributes attributes;
  for (const auto& [name, value] : texts)
    if (!value.empty() && !(date && name == "commandLine")) attributes.push_back({name, value});
  std::string ranges;
  for (const SampleRange& range : figures.ranges) append_word(ranges, to_string(range));
  attributes.push_back({"sampleRanges", ranges});
  attributes.push_back({"samplesPerPixel", std::to_string(count_samples(figures.ranges))});
  attributes.push_back({"rejectedSamples", std::to_string(figures.rejected)});
  if (figures.rays) attributes.push_back({"rays", std::to_string(*figures.rays)});
  if (figures.estimated_error) attributes.push_back({"estimatedError", static_cast<float>(*figures.estimated_error)});
  if (figures.standard_error_unit)
    attributes.push_back({"standardErrorUnit", static_cast<float>(*figures.standard_error_unit)});
  if (!figures.stopped.empty() && !date) attributes.push_back({"stopped", figures.stopped});
  if (date) {
    attributes.push_back({"capDate", date_text(*date)});
    attributes.push_back({"utcOffset", 0.0f});
  } else if (!figures.seconds.empty()) {
    attributes.push_back({"secondsPerPhase", seconds_text(figures.seconds)});
  }
  return attributes;
}

std::optional<std::int64_t> reproducible_date() {
  const char* const given = std::getenv("SOURCE_DATE_EPOCH");
  if (!given) return std::nullopt;
  constexpr std::int64_t last = 253402300799;  // of the year 9999: capDate has four digits for it
  const std::string_view text = given;
  std::int64_t date = -1;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), date);
  if (error != std::errc() || stop != text.data() + text.size() || date < 0 || date > last)
    throw Error(Exit::usage, "SOURCE_DATE_EPOCH '" + std::string(text) + "': expected seconds since 1970, from 0 to " +
                                 std::to_string(last));
  return date;
}

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  std::string line;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find('\0', begin), all.size());
    append_word(line, quoted(std::string_view(all).substr(begin, end - begin)));
    begin = end + 1;
  }
  return line;
}

}  // namespace oclair
