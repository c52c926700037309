#include "options.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "../number.h"
#include "../sample_range.h"
#include "../schedule.h"

namespace oclair {
namespace {

std::optional<std::uint64_t> parse_whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

[[noreturn]] void refuse(const std::string& option, const std::string& given, const std::string& expected) {
  throw Error(Exit::usage, option + " '" + given + "': expected " + expected);
}

void add_definition(Definitions& definitions, const std::string& given) {
  const std::size_t equals = given.find('=');
  if (equals == std::string::npos || equals == 0) refuse("-D", given, "NAME=VALUE");
  definitions[given.substr(0, equals)] = given.substr(equals + 1);
}

constexpr const char* scene_description = "scene file in the Mitsuba XML format";

void add_definitions(CLI::App& line, Definitions& definitions) {
  line.add_option_function<std::vector<std::string>>(
          "-D,--define",
          [&definitions](const std::vector<std::string>& all) {
            for (const std::string& given : all) add_definition(definitions, given);
          },
          "value of $NAME in the scene; may be repeated")
      ->type_name("NAME=VALUE")
      ->type_size(1)
      ->allow_extra_args(false);
}

}  // namespace

void add_scene(CLI::App& line, std::filesystem::path& scene, Definitions& definitions) {
  line.add_option("SCENE", scene, scene_description)->required();
  add_definitions(line, definitions);
}

void add_scene(CLI::App& line, std::optional<std::filesystem::path>& scene, Definitions& definitions) {
  line.add_option("SCENE", scene, scene_description);
  add_definitions(line, definitions);
}

void add_device(CLI::App& line, std::string& device) {
  line.add_option("--device", device, "OpenCL device, by index or part of its name: see `oclair devices`")
      ->type_name("DEVICE");
}

void add_host_memory(CLI::App& line, std::size_t& bytes) {
  line.add_option_function<std::string>(
          "--host-memory",
          [&bytes](const std::string& given) { bytes = static_cast<std::size_t>(whole_number("--host-memory", given, 1, 1 << 24)) << 20; },
          "MiB that the film may take of the host's memory: a larger one lies in files beside the checkpoint; default: half of it")
      ->type_name("N");
}

std::uint64_t whole_number(const std::string& option, const std::string& given, std::uint64_t least, std::uint64_t most) {
  const std::optional<std::uint64_t> number = parse_whole_number(given);
  if (!number || *number < least || *number > most) {
    refuse(option, given, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return *number;
}

Approximations fresnel(const std::string& option, const std::string& given) {
  if (given == "exact") return 0;
  if (given == "schlick") return APPROXIMATION_SCHLICK;
  refuse(option, given, "exact or schlick");
}

bool double_precision(const std::string& option, const std::string& given) {
  if (given == "float") return false;
  if (given == "double") return true;
  refuse(option, given, "float or double");
}

bool exact_kernel(const std::string& option, const std::string& given) {
  if (given == "shared") return false;
  if (given == "exact") return true;
  refuse(option, given, "shared or exact");
}

Aovs aovs(const std::string& option, const std::string& given) {
  Aovs wanted;
  const std::pair<const char*, bool*> names[] = {{"albedo", &wanted.albedo},
                                                 {"normal", &wanted.normal},
                                                 {"depth", &wanted.depth},
                                                 {"uv", &wanted.uv},
                                                 {"primitive", &wanted.primitive}};
  for (std::size_t begin = 0; begin <= given.size();) {
    const std::size_t end = std::min(given.find(',', begin), given.size());
    const std::string name = given.substr(begin, end - begin);
    const auto known = std::find_if(std::begin(names), std::end(names), [&](const auto& entry) { return name == entry.first; });
    if (known == std::end(names)) refuse(option, given, "some of albedo, normal, depth, uv and primitive, joined by commas");
    *known->second = true;
    begin = end + 1;
  }
  return wanted;
}

SamplerKind sampler(const std::string& option, const std::string& given) {
  for (const SamplerKind kind : {SAMPLER_INDEPENDENT, SAMPLER_SOBOL})
    if (given == name_of(kind)) return kind;
  refuse(option, given, "independent or sobol");
}

double duration(const std::string& option, const std::string& given) {
  const std::optional<double> seconds = parse_duration(given);
  if (!seconds) refuse(option, given, "a time such as 90s, 2m or 1.5h, at most 1e9 seconds");
  return *seconds;
}

double real_number(const std::string& option, const std::string& given, double above, double below) {
  const std::optional<double> number = parse_number(given);
  if (!number || !(*number > above) || !(*number < below)) {
    std::ostringstream range;
    range << "a number between " << above << " and " << below;
    refuse(option, given, range.str());
  }
  return *number;
}

SampleRange sample_range(const std::string& option, const std::string& given) {
  const std::size_t colon = std::min(given.find(':'), given.size());
  const auto first = parse_whole_number(std::string_view(given).substr(0, colon));
  const auto count = parse_whole_number(std::string_view(given).substr(std::min(colon + 1, given.size())));
  if (!first || !count || *first % REPLICA_SAMPLES != 0 || *first >= MAX_SAMPLES || *count < 1 || *count > MAX_SAMPLES - *first)
    refuse(option, given, "FIRST:COUNT, FIRST a multiple of " + std::to_string(REPLICA_SAMPLES) + ", COUNT at least 1, both together at most " +
                              std::to_string(MAX_SAMPLES));
  return {*first, *count};
}

bool progress_json(const std::string& option, const std::string& given) {
  if (given == "text") return false;
  if (given == "json") return true;
  refuse(option, given, "text or json");
}

glm::uvec2 film_size(const std::string& option, const std::string& given) {
  constexpr std::uint64_t most = MAX_FILM_SIDE;
  const std::size_t cross = std::min(given.find('x'), given.size());
  const auto width = parse_whole_number(std::string_view(given).substr(0, cross));
  const auto height = parse_whole_number(std::string_view(given).substr(std::min(cross + 1, given.size())));
  const auto fits = [](const std::optional<std::uint64_t>& side) { return side && *side >= 1 && *side <= most; };
  if (!fits(width) || !fits(height)) refuse(option, given, "WIDTHxHEIGHT, both from 1 to " + std::to_string(most));
  return {static_cast<unsigned>(*width), static_cast<unsigned>(*height)};
}

}  // namespace oclair
