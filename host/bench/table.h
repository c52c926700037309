// The results: rows that are printed as they come, kept, and written as JSON.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "targets.h"
#include "timing.h"

namespace oclair::bench {

struct Row {
  std::string name;
  std::string unit;  // of ours and peer's
  std::optional<double> ours, peer;
  std::optional<Spread> ratio;  // what a target is about, unless it is about ours
};

// What a target judges: the median ratio, or else ours.
std::optional<double> figure_of(const Row& row);

class Table {
 public:
  explicit Table(std::ostream& out) : out_(out) {}
  void setting(const std::string& name, const std::string& value);  // of the machine, the versions, the measurement
  void heading(const std::string& text);
  void note(const std::string& text);
  void add(Row row);
  const std::vector<Row>& rows() const { return rows_; }
  Table empty_copy() const { return Table(out_); }
  void take(const std::string& json);                        // the rows and notes of another table, which has printed them
  void print_targets() const;                                // every target with what was measured
  void write_json(const std::filesystem::path& file) const;  // throws Error(Exit::render_failed)
  std::string json() const;

 private:
  std::ostream& out_;
  std::vector<std::pair<std::string, std::string>> settings_;
  std::vector<Row> rows_;
  std::vector<std::string> notes_;
};

}  // namespace oclair::bench
