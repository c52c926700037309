#include "table.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

#include "../error.h"

namespace oclair::bench {
namespace {

constexpr std::size_t name_width = 54;

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string padded(std::string text, std::size_t width, bool right = false) {
  if (text.size() < width) text.insert(right ? 0 : text.size(), width - text.size(), ' ');
  return text;
}

std::string value_text(const std::optional<double>& value) { return value ? formatted("%.4g", *value) : ""; }

std::string ratio_text(const std::optional<Spread>& ratio) {
  return ratio ? formatted("%.3f", ratio->median) + " (" + formatted("%.3f", ratio->least) + "-" +
                     formatted("%.3f", ratio->most) + ")"
               : "";
}

std::string verdict(const Target& target, const std::optional<double>& figure) {
  return (target.at_least ? ">= " : "<= ") + formatted("%.2f", target.value) +
         (!figure                ? "  not measured"
          : met(target, *figure) ? "  met"
                                 : "  NOT met");
}

}  // namespace

std::optional<Target> target_of(const std::string& name) {
  const auto found = std::find_if(std::begin(targets), std::end(targets), [&](const Target& t) { return name == t.name; });
  if (found == std::end(targets)) return std::nullopt;
  return *found;
}

bool met(const Target& target, double figure) { return target.at_least ? figure >= target.value : figure <= target.value; }

std::optional<double> figure_of(const Row& row) { return row.ratio ? std::optional(row.ratio->median) : row.ours; }

void Table::setting(const std::string& name, const std::string& value) {
  settings_.emplace_back(name, value);
  out_ << padded(name, 12) << value << std::endl;
}

void Table::heading(const std::string& text) {
  out_ << "\n"
       << text << "\n"
       << padded("", name_width) << padded("ours", 10, true) << padded("peer", 10, true) << "  " << padded("unit", 10)
       << padded("ratio, median (range)", 24) << "target" << std::endl;
}

void Table::note(const std::string& text) {
  notes_.push_back(text);
  out_ << text << std::endl;
}

void Table::add(Row row) {
  out_ << padded(row.name, name_width) << padded(value_text(row.ours), 10, true) << padded(value_text(row.peer), 10, true)
       << "  " << padded(row.unit, 10) << padded(ratio_text(row.ratio), 24);
  if (const auto target = target_of(row.name)) out_ << verdict(*target, figure_of(row));
  out_ << std::endl;
  rows_.push_back(std::move(row));
}

void Table::print_targets() const {
  out_ << "\n" << padded("targets", name_width) << padded("measured", 10, true) << "  target" << std::endl;
  for (const Target& target : targets) {
    const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.name == target.name; });
    const auto figure = row == rows_.end() ? std::nullopt : figure_of(*row);
    out_ << padded(target.name, name_width) << padded(figure ? formatted("%.3f", *figure) : "-", 10, true) << "  "
         << verdict(target, figure) << std::endl;
  }
}

std::string Table::json() const {
  nlohmann::ordered_json document;
  document["settings"] = nlohmann::ordered_json::object();
  for (const auto& [name, value] : settings_) document["settings"][name] = value;
  document["rows"] = nlohmann::ordered_json::array();
  for (const Row& row : rows_) {
    nlohmann::ordered_json entry{{"name", row.name}, {"unit", row.unit}};
    if (row.ours) entry["ours"] = *row.ours;
    if (row.peer) entry["peer"] = *row.peer;
    if (row.ratio) entry["ratio"] = {{"median", row.ratio->median}, {"least", row.ratio->least}, {"most", row.ratio->most}};
    if (const auto target = target_of(row.name))
      entry["target"] = {{target->at_least ? "at_least" : "at_most", target->value},
                         {"met", met(*target, figure_of(row).value())}};
    document["rows"].push_back(std::move(entry));
  }
  document["notes"] = notes_;
  return document.dump(2);
}

void Table::take(const std::string& json) {
  const nlohmann::ordered_json document = nlohmann::ordered_json::parse(json);
  for (const auto& entry : document["rows"]) {
    Row row{entry["name"], entry["unit"], {}, {}, {}};
    if (entry.contains("ours")) row.ours = entry["ours"];
    if (entry.contains("peer")) row.peer = entry["peer"];
    if (entry.contains("ratio"))
      row.ratio = Spread{entry["ratio"]["median"], entry["ratio"]["least"], entry["ratio"]["most"]};
    rows_.push_back(std::move(row));
  }
  for (const auto& note : document["notes"]) notes_.push_back(note);
}

void Table::write_json(const std::filesystem::path& file) const {
  std::ofstream stream(file);
  stream << json() << "\n";
  if (!stream.flush())
    throw Error(Exit::render_failed, file.string() + ": cannot be written, expected a file in a writable directory");
}

}  // namespace oclair::bench
