// What tune has found, as a table for people and as JSON.
#pragma once

#include <ostream>
#include <string>

#include "../settings_file.h"
#include "tune.h"

namespace oclair::tune {

void print_table(const Result& result, std::ostream& out);

// One line: what to use, and how sure that is.
std::string advice(const Result& result);

std::string json_of(const Result& result);

// What is recommended, with its measured bias: without choices if that is the accurate setting.
SettingsFile settings_of(const Result& result);

// "-0.12 %", "1.04" and the like.
std::string percent(double share, int digits = 2);
std::string number(double value, int digits = 3);

// How the bias of a row is told: that it has none, or its interval and its bound.
std::string bias_text(const Row& row);

}  // namespace oclair::tune
