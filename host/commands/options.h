// Options that several commands have, and values that are checked alike. Each wrong value is an Error(Exit::usage) that says
// what was given and what was expected.
#pragma once

#include <CLI/CLI.hpp>

#include "commands.h"

namespace oclair {

void add_scene(CLI::App& line, std::filesystem::path& scene, Definitions& definitions);
void add_scene(CLI::App& line, std::optional<std::filesystem::path>& scene, Definitions& definitions);
void add_device(CLI::App& line, std::string& device);
void add_host_memory(CLI::App& line, std::size_t& bytes);  // of film, in memory

std::uint64_t whole_number(const std::string& option, const std::string& given, std::uint64_t least, std::uint64_t most);
Approximations fresnel(const std::string& option, const std::string& given);  // exact or schlick
bool double_precision(const std::string& option, const std::string& given);  // float or double
bool exact_kernel(const std::string& option, const std::string& given);  // shared or exact
Aovs aovs(const std::string& option, const std::string& given);  // names joined by commas
SamplerKind sampler(const std::string& option, const std::string& given);     // independent or sobol
double duration(const std::string& option, const std::string& given);         // seconds, of 90s, 2m, 1.5h
double real_number(const std::string& option, const std::string& given, double above, double below);
SampleRange sample_range(const std::string& option, const std::string& given);  // FIRST:COUNT, as a part of a render can be
bool progress_json(const std::string& option, const std::string& given);  // text or json
glm::uvec2 film_size(const std::string& option, const std::string& given);  // WIDTHxHEIGHT

}  // namespace oclair
