// The table of extremes against what the tests have recorded, and docs/extremes.md, which is made of both. ctest runs this after
// the others.
#include "extremes.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "../host/device.h"
#include "extremes_rows.h"
#include "temporary_directory.h"

using namespace oclair::test;

namespace {

namespace fs = std::filesystem;

struct Record {
  double measured, bound;
};

// When the tests, or the kernels that they compile, were last changed.
fs::file_time_type last_change() {
  fs::file_time_type last = fs::last_write_time("/proc/self/exe");
  for (const fs::path& directory : {oclair::kernel_directory(), fs::path(OCLAIR_TEST_DIRECTORY)})
    for (const auto& entry : fs::directory_iterator(directory))
      if (const std::string kind = entry.path().extension().string(); kind == ".cl" || (kind == ".h" && directory == oclair::kernel_directory()))
        last = std::max(last, entry.last_write_time());
  return last;
}

// What this run or an earlier one of these tests has recorded, by extreme_record. Of what was recorded before they were last changed
// nobody knows whether they would record it again.
std::map<std::string, Record> read_records(const fs::path& directory = extremes_directory()) {
  std::map<std::string, Record> records;
  if (directory.empty()) throw std::runtime_error("OCLAIR_EXTREMES is not set: run ctest");
  const fs::file_time_type changed = last_change();
  for (const auto& entry : fs::directory_iterator(directory)) {
    if (entry.last_write_time() < changed) continue;
    std::ifstream file(entry.path());
    Record record{};
    EXPECT_TRUE(file >> record.measured >> record.bound) << entry.path();
    records[entry.path().filename().string()] = record;
  }
  return records;
}

std::set<std::string> names_of_all_tests() {
  std::set<std::string> names;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t)
      names.insert(std::string(suite.name()) + "." + suite.GetTestInfo(t)->name());
  }
  return names;
}

std::filesystem::path page_path() { return std::filesystem::path(OCLAIR_TEST_DIRECTORY).parent_path() / "docs/extremes.md"; }

std::string digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

std::string figure(const ExtremeTest& test, const Record& record) {
  if (test.of.empty()) return "holds";
  return "measured " + digits(record.measured) + ", bound " + digits(record.bound) + " (" + test.of + ")";
}

std::string page(const std::map<std::string, Record>& records) {
  std::ostringstream text;
  text << R"(# Extremes

Where renderers in float32 go wrong, what happens elsewhere, and what oclair does. Below each: the tests that guard it, each
with the worst figure of one run and the bound that it must keep, which is derived in the test. "holds": the law has no single
figure, the test judges each of its cases. u is 2^-24. Seeds are fixed; means are judged in standard errors.

This page is made by `cmake --build build/release --target extremes_page`, after `./test`, of `tests/extremes_rows.h` and of
what the tests record. The test `extremes` fails if it is not, if a test that is named here does not exist or records nothing,
or if a figure exceeds its bound.
)";
  for (const ExtremeGroup& group : extreme_groups()) {
    text << "\n## " << group.title << "\n";
    for (const Extreme& extreme : group.extremes) {
      text << "\n**" << extreme.row << " " << extreme.title << ".** " << extreme.elsewhere << " *Here:* " << extreme.here
           << "\n";
      if (!extreme.tests.empty()) text << "\n";
      for (const ExtremeTest& test : extreme.tests) {
        const auto found = records.find(extreme_record(extreme.row, test.name));
        text << "- `" << test.name << "`: " << figure(test, found == records.end() ? Record{} : found->second) << "\n";
      }
    }
  }
  return text.str();
}

// A line without its measured figure, which differs between machines.
std::string without_figure(const std::string& line) {
  const std::size_t begin = line.find(": measured "), end = line.find(", bound ");
  return begin == std::string::npos || end == std::string::npos ? line : line.substr(0, begin) + line.substr(end);
}

}  // namespace

TEST(extremes, every_row_has_a_test_or_an_argument_and_stands_once) {
  int number = 0;
  for (const ExtremeGroup& group : extreme_groups())
    for (const Extreme& extreme : group.extremes) {
      EXPECT_EQ(extreme.row, "X" + std::to_string(++number));
      EXPECT_FALSE(extreme.elsewhere.empty() || extreme.here.empty()) << extreme.row;
    }
  EXPECT_EQ(number, 50);
}

TEST(extremes, every_named_test_exists_and_has_recorded_a_figure_within_its_bound) {
  const std::map<std::string, Record> records = read_records();
  const std::set<std::string> tests = names_of_all_tests();
  std::set<std::string> named;
  for (const ExtremeGroup& group : extreme_groups())
    for (const Extreme& extreme : group.extremes)
      for (const ExtremeTest& test : extreme.tests) {
        EXPECT_TRUE(tests.count(test.name)) << extreme.row << " names " << test.name;
        named.insert(extreme_record(extreme.row, test.name));
        const auto record = records.find(extreme_record(extreme.row, test.name));
        if (record == records.end()) {
          ADD_FAILURE() << extreme.row << ": no figure of " << test.name << " since tests or kernels were changed; run all tests first";
          continue;
        }
        EXPECT_LE(record->second.measured, record->second.bound) << extreme.row << " " << test.name;
        EXPECT_EQ(test.of.empty(), record->second.bound == 0.0)
            << extreme.row << " " << test.name << ": a law, or a figure of what?";
      }
  for (const auto& [name, record] : records) {
    const bool of_a_test = tests.count(name.substr(name.find('.') + 1)) != 0;  // or one that another commit had in this build
    EXPECT_TRUE(!of_a_test || named.count(name)) << name << " is recorded, and stands in no row";
  }
}

TEST(extremes, the_page_is_made_of_the_rows_and_its_figures_keep_their_bounds) {
  std::ifstream file(page_path());
  std::istringstream expected(page(read_records()));
  std::string line, wanted;
  int number = 0;
  while (std::getline(expected, wanted)) {
    ++number;
    ASSERT_TRUE(std::getline(file, line)) << page_path() << " ends at line " << number << "; build the target extremes_page";
    ASSERT_EQ(without_figure(line), without_figure(wanted)) << "line " << number << "; build the target extremes_page";
    const std::size_t measured = line.find(": measured "), bound = line.find(", bound ");
    if (measured == std::string::npos || bound == std::string::npos) continue;
    EXPECT_LE(std::stod(line.substr(measured + 11)), std::stod(line.substr(bound + 8))) << "line " << number;
  }
  EXPECT_FALSE(std::getline(file, line)) << page_path() << " goes on after its last line";
}

TEST(extremes, what_was_recorded_before_the_tests_were_changed_does_not_count) {
  const TemporaryDirectory directory;
  for (const char* name : {"X1.old", "X1.new"}) std::ofstream(directory / name) << "0.5 1\n";
  fs::last_write_time(directory / "X1.old", last_change() - std::chrono::seconds(1));
  const std::map<std::string, Record> records = read_records(directory / "");
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records.begin()->first, "X1.new");
}

// What the target extremes_page runs.
TEST(extremes, DISABLED_write_page) {
  const std::map<std::string, Record> records = read_records();
  for (const ExtremeGroup& group : extreme_groups())
    for (const Extreme& extreme : group.extremes)
      for (const ExtremeTest& test : extreme.tests)
        ASSERT_TRUE(records.count(extreme_record(extreme.row, test.name))) << "no figure of " << test.name << "; run all tests first";
  std::ofstream file(page_path());
  file << page(records);
  EXPECT_TRUE(file.flush().good()) << page_path();
}
