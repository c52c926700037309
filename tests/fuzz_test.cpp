// tests/data/fuzz: files that have crashed a reader, kept it busy or made it take memory, most of them found by the fuzz targets
// (fuzz/). Each lies in the directory of its reader, its name says what it does.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "file_readers.h"
#include "files.h"

using namespace oclair::test;

namespace {

namespace fs = std::filesystem;

struct Found {
  NamedReader reader;
  fs::path file;
};

std::vector<Found> found() {
  std::vector<Found> result;
  for (const NamedReader& reader : FILE_READERS) {
    const fs::path directory = fs::path(OCLAIR_TEST_DIRECTORY) / "data" / "fuzz" / reader.name;
    if (!fs::exists(directory)) continue;  // nothing has been found in this reader
    for (const auto& entry : fs::directory_iterator(directory)) result.push_back({reader, entry.path()});
  }
  std::sort(result.begin(), result.end(), [](const Found& a, const Found& b) { return a.file < b.file; });
  return result;
}

// KiB, of a line of the system's status file.
long status(const std::string& name) {
  std::istringstream lines(content("/proc/self/status"));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(name + ":")) return std::stol(line.substr(name.size() + 1));
  return 0;
}

long peak_memory() { return status("VmHWM"); }  // that was in use since the last call of forget_peak

void forget_peak() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5";
  EXPECT_TRUE(file.flush().good());
}

// While it lives there are so many KiB of memory to be asked for beside what there is, touched or not.
class MemoryLimit {
 public:
  explicit MemoryLimit(long more) {
    getrlimit(RLIMIT_AS, &before_);
    const rlimit limit{static_cast<rlim_t>(status("VmSize") + more) * 1024, before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_{};
};

class fuzz_test : public testing::TestWithParam<Found> {};

// The files have some KiB at most: those that are not refused need little, too.
TEST_P(fuzz_test, is_taken_or_refused_on_one_line_in_little_memory) {
  const std::string bytes = content(GetParam().file);
  EXPECT_EQ(std::vector<char>(std::size_t{64} << 20, 1).back(), 1);  // as an earlier file may have taken them
  const long earlier = peak_memory();
  forget_peak();
  const long before = peak_memory();
  ASSERT_LT(before, earlier - 60 * 1024);
  std::string refusal;
  {
    const MemoryLimit limit(256 * 1024);
    ASSERT_NO_THROW(refusal = GetParam().reader.read(bytes));
  }
  EXPECT_EQ(refusal.find("alloc"), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
  EXPECT_LT(peak_memory() - before, 128 * 1024) << refusal;
}

INSTANTIATE_TEST_SUITE_P(, fuzz_test, testing::ValuesIn(found()), [](const auto& test) {
  return std::string(test.param.reader.name) + "_" + test.param.file.stem().string();
});

}  // namespace
