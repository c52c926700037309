// Figures for docs/extremes.md. A test that guards a row of that table records how far it got, next to the bound that it keeps.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace oclair::test {

// Where the records of a run lie: ctest sets OCLAIR_EXTREMES. Empty: nothing is recorded.
inline std::filesystem::path extremes_directory() {
  const char* directory = std::getenv("OCLAIR_EXTREMES");
  return directory ? directory : "";
}

// Name of the record of one test for one row: a file of its own, because tests run side by side.
inline std::string extreme_record(const std::string& row, const std::string& test) { return row + "." + test; }

inline void write_extreme_record(const std::string& row, double measured, double bound) {
  if (extremes_directory().empty()) return;
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::ofstream record(extremes_directory() / extreme_record(row, std::string(test.test_suite_name()) + "." + test.name()));
  record << measured << " " << bound << "\n";
  EXPECT_TRUE(record.flush().good()) << extremes_directory();
}

// At most once per test and row. `measured` is the worst figure of the whole test; that it keeps the bound is judged here. What it
// is a figure of says the table (tests/extremes_rows.h).
inline void record_extreme(const std::string& row, double measured, double bound) {
  EXPECT_LE(measured, bound) << "extreme " << row;
  write_extreme_record(row, measured, bound);
}

// The last statement of a test whose law has no single figure: it holds in all its cases, or it does not.
inline void record_law(const std::string& row) { write_extreme_record(row, testing::Test::HasFailure() ? 1.0 : 0.0, 0.0); }

}  // namespace oclair::test
