// A film that lies in files: the same results, little memory, nothing left behind, and a message where there is no room.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>

#include "../host/error.h"
#include "../host/film_vector.h"
#include "checkpoint_cases.h"
#include "faults.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string scene = (fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes/cornell-boxes.xml").string();
const Arguments in_file = {"--host-memory", "1"};

class film_file_test : public testing::Test {
 protected:
  film_file_test() { setenv("SOURCE_DATE_EPOCH", "0", 1); }
  ~film_file_test() override { unsetenv("SOURCE_DATE_EPOCH"); }

  std::string path(const std::string& name) const { return (directory / name).string(); }
  Arguments render(const std::string& name, const Arguments& more, const Arguments& still_more = {}) const {
    Arguments all = {"render", scene, "-o", path(name + ".exr"), "--checkpoint", path(name + ".checkpoint")};
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), still_more.begin(), still_more.end());
    return all;
  }

  FilmDirectory place() const { return std::make_shared<const fs::path>(directory / ""); }

  TemporaryDirectory directory;
};

ProgramResult expect_success(const Arguments& arguments) {
  const ProgramResult result = run_oclair(arguments);
  EXPECT_EQ(result.exit, 0) << result.err;
  return result;
}

// What the system says of a running process, in KiB: "VmHWM" is the most memory that it has held.
std::size_t status_of(pid_t process, const std::string& name) {
  std::istringstream lines(content("/proc/" + std::to_string(process) + "/status"));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(name + ":")) return std::stoul(line.substr(name.size() + 1));
  return 0;
}

// Bytes of memory that the program has held at most.
std::size_t most_memory(const Arguments& arguments, int exit = 0) {
  std::size_t most = 0;
  const ProgramResult result = run_oclair(arguments, [&](pid_t process) {
    while (!has_ended(process)) {
      most = std::max(most, status_of(process, "VmHWM"));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_EQ(result.exit, exit) << result.err;
  return most << 10;
}

std::string refusal(const FilmDirectory& place, std::size_t bytes) {
  try {
    const FilmVector<char> array(bytes, FilmAllocator<char>(place));
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_F(film_file_test, an_array_in_a_file_is_zero_and_holds_what_is_written_also_when_its_memory_is_let_go) {
  const std::size_t count = 3 * FILM_PIECE + 17;
  FilmVector<std::uint64_t> array(count, FilmAllocator<std::uint64_t>(place()));
  EXPECT_EQ(std::count(array.begin(), array.end(), 0u), static_cast<std::ptrdiff_t>(count));
  for_each_element(count, [&](std::size_t i) { array[i] = i * i + 1; }, array);
  for (const auto& [first, end] : {std::pair<std::size_t, std::size_t>{0, count}, {5, 6}, {1000, 60000}, {count - 1, count}, {7, 7}})
    release(array, first, end);
  std::size_t wrong = 0;
  for_each_element(count, [&](std::size_t i) { wrong += array[i] != i * i + 1; }, array);
  EXPECT_EQ(wrong, 0u);
  EXPECT_TRUE(directory.names().empty());  // it has no name
}

// The system places mappings of one size side by side, downwards: what is private and lies behind an array would be lost for good.
TEST_F(film_file_test, letting_go_ends_with_the_array) {
  constexpr std::size_t size = 1 << 20;
  std::vector<FilmVector<char>> arrays;
  std::vector<char*> blocks;
  do {
    blocks.push_back(static_cast<char*>(mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)));
    arrays.emplace_back(size, FilmAllocator<char>(place()));
  } while (arrays.back().data() + size != blocks.back() && blocks.size() < 100);
  ASSERT_EQ(arrays.back().data() + size, blocks.back());
  *blocks.back() = 7;
  release(arrays.back(), 5, 2 * size);
  EXPECT_EQ(*blocks.back(), 7);
  for (char* const block : blocks) munmap(block, size);
}

TEST_F(film_file_test, a_copy_is_another_array_and_a_film_moves_between_memory_and_files) {
  FilmVector<int> a({1, 2, 3}, FilmAllocator<int>(place()));
  FilmVector<int> b = a;
  b[0] = 7;
  EXPECT_EQ(a[0], 1);
  FilmVector<int> c{4, 5};
  c.swap(a);
  EXPECT_EQ(c, (std::vector<int, FilmAllocator<int>>{{1, 2, 3}, c.get_allocator()}));
  EXPECT_FALSE(a.get_allocator().directory);
  a = std::move(b);
  EXPECT_EQ(a[0], 7);
  EXPECT_TRUE(a.get_allocator().directory);
}

TEST_F(film_file_test, where_there_is_no_room_for_a_file_that_is_said_and_nothing_stays) {
  const std::string expected = ": 3 MiB of the film cannot lie here: ";
  EXPECT_EQ(refusal(place(), 3 << 20), "");
  {
    const FileSizeLimit full(1 << 20);
    EXPECT_EQ(refusal(place(), 1 << 20), "");
    EXPECT_EQ(refusal(place(), 3 << 20).find((directory / "").string() + expected + "File too large"), 0u);
  }
  const fs::path missing = directory / "none", locked = directory / "locked";
  EXPECT_EQ(refusal(std::make_shared<const fs::path>(missing), 3 << 20).find(missing.string() + expected + "No such file"), 0u);
  fs::create_directory(locked);
  {
    const ReadOnlyDirectory guard(locked);
    EXPECT_EQ(refusal(std::make_shared<const fs::path>(locked), 3 << 20).find(locked.string() + expected + "Permission denied"), 0u);
  }
  EXPECT_NE(refusal(place(), std::size_t{1} << 60), "");  // more than any disk has
  EXPECT_EQ(directory.names(), std::vector<std::string>{"locked"});
}

// The program itself: a limit on the size of files, whose signal nobody ignores for it.
TEST_F(film_file_test, a_disk_without_room_ends_a_render_with_a_message_before_its_first_sample) {
  const FileSizeLimit full(16 << 20);
  signal(SIGXFSZ, SIG_DFL);
  const ProgramResult result = run_oclair(render("a", in_file, {"--size", "1024x1024", "--spp", "1"}));  // pixels: 64 MiB
  EXPECT_EQ(result.exit, 1) << result.err;
  EXPECT_NE(result.err.find("64 MiB of the film cannot lie here: File too large, expected "), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("passes"), std::string::npos) << result.err;
  EXPECT_TRUE(directory.names().empty());
}

// What --error keeps of 1024x1024 pixels is 72 MiB, less than the film's largest array, so it is asked for first. 8192x8 pixels are one
// band, of which the device holds all: the pixels are 4 MiB.
TEST_F(film_file_test, room_for_the_error_and_for_a_film_of_one_band_is_taken_before_the_first_sample_too) {
  const auto refused = [&](std::size_t limit, const Arguments& options, const std::string& size) {
    const FileSizeLimit full(limit << 20);
    const ProgramResult result = run_oclair(render("a", in_file, options));
    EXPECT_EQ(result.exit, 1) << result.err;
    EXPECT_NE(result.err.find(size + " MiB of the film cannot lie here: File too large, expected "), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("passes"), std::string::npos) << result.err;
  };
  refused(68, {"--size", "1024x1024", "--spp", "1", "--error", "0.1"}, "72");
  refused(2, {"--size", "8192x8", "--spp", "1"}, "4");
}

// The files of a film in one band are those of its beginning until its end, with a resume between.
TEST_F(film_file_test, a_film_of_one_band_in_files_gives_the_film_of_one_in_memory) {
  const Arguments size = {"--size", "8192x8", "--max-depth", "1"};
  expect_success(render("a", size, {"--spp", "3"}));
  expect_success(render("b", size, {"--spp", "1", "--host-memory", "1"}));
  expect_success(render("b", size, {"--spp", "3", "--host-memory", "1", "--resume"}));
  expect_same_film(read_checkpoint(path("a.checkpoint")).film, read_checkpoint(path("b.checkpoint")).film);
}

// 184 bytes a pixel: 200x130 are 4.6 MiB. The head of a checkpoint holds the command line; what follows is compared.
TEST_F(film_file_test, a_film_in_files_gives_the_image_and_the_checkpoint_of_one_in_memory) {
  const Arguments options = {"--size", "200x130", "--spp", "33", "--png", "--aov", "depth,uv", "--error", "1e-6"};
  Arguments stopped = options;
  stopped[3] = "17";
  EXPECT_EQ(run_oclair(render("a", options)).exit, 5);
  EXPECT_EQ(run_oclair(render("b", stopped, in_file)).exit, 5);
  const ProgramResult rest = run_oclair(render("b", options, {"--host-memory", "1", "--resume"}));
  EXPECT_EQ(rest.exit, 5);
  EXPECT_NE(rest.err.find("in files beside the checkpoint"), std::string::npos) << rest.err;
  EXPECT_TRUE(content(path("a.exr")) == content(path("b.exr")) && !content(path("a.exr")).empty());
  EXPECT_TRUE(content(path("a.png")) == content(path("b.png")) && !content(path("a.png")).empty());
  const Checkpoint a = read_checkpoint(path("a.checkpoint")), b = read_checkpoint(path("b.checkpoint"));
  expect_same_film(a.film, b.film);
  expect_same_layers(a.layers, b.layers);
  const std::string bytes_a = content(path("a.checkpoint")), bytes_b = content(path("b.checkpoint"));
  constexpr std::size_t arrays = 200 * 130 * (184 + 3 * 4);
  ASSERT_GT(std::min(bytes_a.size(), bytes_b.size()), arrays);
  EXPECT_TRUE(bytes_a.substr(bytes_a.size() - arrays) == bytes_b.substr(bytes_b.size() - arrays));
}

TEST_F(film_file_test, parts_merge_in_files_to_the_whole_render_in_memory) {
  const Arguments size = {"--size", "200x130"};
  expect_success(render("whole", size, {"--spp", "40"}));
  expect_success(render("a", size, {"--samples", "0:16", "--host-memory", "1"}));
  expect_success(render("b", size, {"--samples", "16:24"}));
  for (const std::string order : {"ab", "ba"}) {
    Arguments merge = {"merge", "-o", path("joined.exr"), "--host-memory", "1", "--checkpoint", path(order + ".joined")};
    for (const char part : order) merge.push_back(path(std::string(1, part) + ".checkpoint"));
    expect_success(merge);
    EXPECT_TRUE(content(path("joined.exr")) == content(path("whole.exr")));
    expect_same_film(read_checkpoint(path(order + ".joined")).film, read_checkpoint(path("whole.checkpoint")).film);
  }
  const FileSizeLimit full(1 << 20);
  const ProgramResult refused = run_oclair({"merge", "-o", path("b.exr"), "--host-memory", "1", path("a.checkpoint"), path("b.checkpoint")});
  EXPECT_EQ(refused.exit, 1);
  EXPECT_NE(refused.err.find("of the film cannot lie here: File too large"), std::string::npos) << refused.err;
}

// 1024^2 pixels take 184 MiB. What a film of 16^2 pixels costs is the program, its compiler and its scene; what the large one costs
// beyond that must be below an eighth of the film: the rows of an image that are written at a time, with their values, are
// 64 x 1024 x (184 + 32) bytes, 14 MiB, a band is less.
TEST_F(film_file_test, a_render_in_files_a_merge_and_info_hold_an_eighth_of_the_film_in_memory_at_most) {
  constexpr std::size_t film = std::size_t{1024} * 1024 * 184;
  const Arguments small = {"--size", "16x16", "--max-depth", "1"}, large = {"--size", "1024x1024", "--max-depth", "1", "--host-memory", "4"};
  const auto memory = [&](const std::string& name, const Arguments& size, const Arguments& more, int exit = 0) {
    return most_memory(render(name, size, more), exit);
  };
  const auto merge = [&](const std::string& a, const std::string& b, const std::string& limit) {
    return most_memory({"merge", path(a), path(b), "-o", path("joined.exr"), "--host-memory", limit});
  };
  memory("kernels", small, {"--spp", "1"});  // compiles them
  const std::size_t least = memory("x", small, {"--samples", "0:1"});
  ASSERT_GT(least, 0u);
  EXPECT_LT(memory("a", large, {"--samples", "0:1", "--png"}), least + film / 8);
  EXPECT_LT(memory("a", large, {"--samples", "0:2", "--resume"}), least + film / 8);
  EXPECT_LT(memory("b", large, {"--samples", "16:1", "--error", "0.001"}, 5), least + film / 8);
  EXPECT_LT(most_memory({"info", path("b.checkpoint")}), least + film / 8);
  memory("y", small, {"--samples", "16:1"});
  const std::size_t least_merge = merge("x.checkpoint", "y.checkpoint", "1");
  EXPECT_LT(merge("a.checkpoint", "b.checkpoint", "4"), least_merge + film / 8);
  EXPECT_GT(merge("a.checkpoint", "b.checkpoint", "1000"), least_merge + film);  // what lies in memory shows
}

TEST_F(film_file_test, a_killed_render_leaves_no_file_of_its_film) {
  bool seen = false;
  const ProgramResult result = run_oclair(render("a", in_file, {"--size", "512x512", "--spp", "100000", "--every", "1h"}), [&](pid_t process) {
    while (!seen && !has_ended(process)) {
      seen = content("/proc/" + std::to_string(process) + "/maps").find((directory / "").string()) != std::string::npos;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(process, SIGKILL);
  });
  EXPECT_TRUE(seen) << result.err;
  EXPECT_EQ(result.exit, 128 + SIGKILL);
  const std::vector<std::string> names = directory.names();
  EXPECT_TRUE(names.empty() || names == std::vector<std::string>{"a.checkpoint.lock"});
}
