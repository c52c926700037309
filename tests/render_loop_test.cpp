// Renders that are stopped, resumed, limited and cut into parts, by the program itself.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "../host/commands/render_loop.h"
#include "../host/error.h"
#include "faults.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"
#include "worlds.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string scene = (fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes/cornell-boxes.xml").string();

// Of a file that is there.
std::string bytes_of(const fs::path& file) {
  EXPECT_TRUE(fs::exists(file)) << file;
  return content(file);
}

Arguments render(const fs::path& image, const Arguments& more) {
  Arguments all = {"render", scene, "-o", image.string()};
  all.insert(all.end(), more.begin(), more.end());
  if (std::find(more.begin(), more.end(), "--size") == more.end()) all.insert(all.end(), {"--size", "16x16"});
  return all;
}

ProgramResult expect_exit(int exit, const Arguments& arguments) {
  const ProgramResult result = run_oclair(arguments);
  EXPECT_EQ(result.exit, exit) << result.err;
  return result;
}

std::vector<nlohmann::json> events_of(const std::string& lines) {
  std::vector<nlohmann::json> events;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) events.push_back(nlohmann::json::parse(line));
  return events;
}

// Images are compared with nothing in their headers that differs between two runs.
class render_loop_test : public testing::Test {
 protected:
  render_loop_test() { setenv("SOURCE_DATE_EPOCH", "0", 1); }
  ~render_loop_test() override { unsetenv("SOURCE_DATE_EPOCH"); }

  fs::path image(const std::string& name) const { return directory / (name + ".exr"); }
  fs::path checkpoint(const std::string& name) const { return directory / (name + ".checkpoint"); }

  TemporaryDirectory directory;
};

// The program runs, and gets each signal once it has said, since the one before, what belongs to it; how it ends.
int exit_after_signals(const Arguments& arguments, const std::vector<std::pair<std::string, int>>& signals, std::string& err) {
  int pipe_ends[2];
  EXPECT_EQ(pipe(pipe_ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    dup2(pipe_ends[1], STDERR_FILENO);
    close(pipe_ends[0]), close(pipe_ends[1]);
    for (const int stop : {SIGINT, SIGTERM}) ::signal(stop, SIG_DFL);
    std::vector<char*> words{const_cast<char*>("oclair")};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(OCLAIR_PROGRAM, words.data());
    _exit(127);
  }
  close(pipe_ends[1]);
  std::size_t sent = 0, heard = 0;
  char buffer[4096];
  for (ssize_t count; (count = read(pipe_ends[0], buffer, sizeof buffer)) > 0;) {
    err.append(buffer, static_cast<std::size_t>(count));
    if (sent == signals.size() || err.find(signals[sent].first, heard) == std::string::npos) continue;
    heard = err.size();
    EXPECT_EQ(kill(child, signals[sent++].second), 0);
  }
  close(pipe_ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(sent, signals.size()) << err;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_F(render_loop_test, a_signal_ends_the_pass_writes_everything_and_exits_5) {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::string err;
    const Arguments endless =
        render(image("a"), {"--png", "--spp", "1000000000", "--progress", "json", "--restart", "--size", "64x64"});
    EXPECT_EQ(exit_after_signals(endless, {{"\"event\":\"samples\"", signal}}, err), 5);
    const auto last = events_of(err).back();
    EXPECT_EQ(last["event"], "finish");
    EXPECT_EQ(last["reason"], "signal");
    EXPECT_EQ(last["exit"], 5);
    EXPECT_TRUE(fs::exists(image("a")) && fs::exists(directory / "a.png") && fs::exists(checkpoint("a")));
    EXPECT_FALSE(fs::exists(directory / "a.checkpoint.lock"));
  }
}

// Nothing else would write a checkpoint within an hour.
TEST_F(render_loop_test, usr1_writes_the_files_and_the_render_goes_on) {
  std::string err;
  const Arguments endless = render(image("a"), {"--spp", "1000000000", "--progress", "json", "--every", "1h", "--size", "64x64"});
  EXPECT_EQ(exit_after_signals(endless,
                               {{"\"event\":\"samples\"", SIGUSR1}, {"\"event\":\"checkpoint\"", 0}, {"\"event\":\"samples\"", SIGTERM}}, err),
            5);
  const auto events = events_of(err);
  EXPECT_EQ(std::count_if(events.begin(), events.end(), [](const auto& e) { return e["event"] == "checkpoint"; }), 2);
}

TEST_F(render_loop_test, a_viewer_is_shown_the_image_and_one_that_is_not_there_costs_a_warning) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string to = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  const ProgramResult refused = expect_exit(0, render(image("a"), {"--spp", "2", "--tev", to}));  // nobody listens yet
  EXPECT_NE(refused.err.find("warning: "), std::string::npos) << refused.err;
  ASSERT_EQ(listen(listener, 1), 0);
  const timeval patience{60, 0};  // for accept: a program that does not come fails the test, it does not hang it
  ASSERT_EQ(setsockopt(listener, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience), 0);
  std::size_t received = 0;
  std::thread viewer([&] {
    const int connection = accept(listener, nullptr, nullptr);
    char buffer[4096];
    for (ssize_t count; (count = read(connection, buffer, sizeof buffer)) > 0;) received += static_cast<std::size_t>(count);
    close(connection);
  });
  const ProgramResult shown = expect_exit(0, render(image("b"), {"--spp", "2", "--tev", to}));
  viewer.join();
  close(listener);
  EXPECT_EQ(shown.err.find("warning: "), std::string::npos) << shown.err;
  EXPECT_GE(received, 16u * 16 * 3 * sizeof(float));
  EXPECT_EQ(bytes_of(image("a")), bytes_of(image("b")));
}

TEST_F(render_loop_test, a_resumed_render_is_the_uninterrupted_one_bit_for_bit) {
  for (const char* sampler : {"independent", "sobol"})
    for (const char* first : {"1", "16", "21"}) {  // within a replica, and at its end
      const auto with = [&](Arguments more) { return more.insert(more.end(), {"--sampler", sampler}), more; };
      expect_exit(0, render(image("whole"), with({"--spp", "40", "--png"})));
      expect_exit(0, render(image("part"), with({"--spp", first, "--checkpoint", checkpoint("part").string(), "--restart"})));
      EXPECT_NE(bytes_of(image("whole")), bytes_of(image("part")));
      expect_exit(0, render(image("part"), with({"--spp", "40", "--png", "--resume"})));
      EXPECT_EQ(bytes_of(image("whole")), bytes_of(image("part"))) << sampler << " " << first;
      EXPECT_EQ(bytes_of(directory / "whole.png"), bytes_of(directory / "part.png"));
      EXPECT_TRUE(fs::exists(checkpoint("part")));    // somebody has asked for it
      EXPECT_FALSE(fs::exists(checkpoint("whole")));  // nobody has
    }
}

TEST_F(render_loop_test, a_pipe_in_the_place_of_a_checkpoint_is_refused_and_not_waited_for) {
  ASSERT_EQ(mkfifo(checkpoint("a").c_str(), 0600), 0);
  for (const std::string how : {"--resume", "--restart"}) {
    const ProgramResult result = run_oclair_for(60.0, render(image("a"), {"--spp", "1", how}));
    EXPECT_EQ(result.exit, 1) << result.err;
    EXPECT_NE(result.err.find("a.checkpoint: is not a checkpoint, expected one or no file"), std::string::npos) << result.err;
  }
  const ProgramResult info = run_oclair_for(60.0, {"info", checkpoint("a").string()});
  EXPECT_EQ(info.exit, 1) << info.err;
  EXPECT_NE(info.err.find("a.checkpoint: is not a regular file, expected a checkpoint"), std::string::npos) << info.err;
}

TEST_F(render_loop_test, no_file_is_overwritten_that_is_something_else) {
  expect_exit(0, render(image("a"), {"--samples", "0:16"}));
  expect_exit(0, render(image("b"), {"--samples", "16:16"}));
  const fs::path own_scene = directory / "scene.xml";
  fs::copy_file(scene, own_scene);
  const std::string a = checkpoint("a").string(), b = checkpoint("b").string(), c = image("c").string(), before = bytes_of(a);
  const std::vector<std::pair<Arguments, std::string>> wrong = {
      {{"merge", b, "-o", c, "--checkpoint", a}, "expected a name that is not there yet, or one of the parts"},
      {{"merge", a, b, "-o", c, "--checkpoint", c}, "expected a file of its own"},
      {{"merge", a, b, "-o", c, "--checkpoint", ""}, "expected a name"},
      {{"render", scene, "--spp", "1", "--size", "8x8", "-o", c, "--checkpoint", c}, "expected a file of its own"},
      {{"render", own_scene, "--spp", "1", "--size", "8x8", "-o", c, "--checkpoint", own_scene, "--restart"}, "expected a file of its own"},
      {{"render", scene, "--spp", "1", "--size", "8x8", "-o", c, "--checkpoint", own_scene, "--restart"}, "is not a checkpoint"},
      {{"render", scene, "--spp", "1", "--size", "8x8", "-o", directory / "c.png", "--aov", "depth"}, "a PNG has no layers"},
  };
  for (const auto& [arguments, message] : wrong) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_TRUE(result.exit == 1 || result.exit == 2) << message << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << message << ":\n" << result.err;
    EXPECT_FALSE(fs::exists(c)) << message;
  }
  EXPECT_TRUE(bytes_of(a) == before);
  EXPECT_TRUE(bytes_of(own_scene) == bytes_of(scene));
  expect_exit(0, {"merge", a, b, "-o", c, "--checkpoint", a});  // one of the parts
}

// Nothing is written within an hour, and nothing at all before the first pass has ended.
TEST_F(render_loop_test, a_restart_that_ends_before_it_has_written_anything_keeps_the_checkpoint) {
  expect_exit(0, render(image("a"), {"--spp", "2", "--checkpoint", checkpoint("a").string()}));
  const std::string before = bytes_of(checkpoint("a"));
  std::string err;
  const Arguments endless = render(image("a"), {"--spp", "1000000000", "--progress", "json", "--every", "1h", "--restart", "--size", "1024x1024"});
  EXPECT_EQ(exit_after_signals(endless, {{"\"phase\":\"passes\"", SIGKILL}}, err), 128 + SIGKILL);
  EXPECT_TRUE(bytes_of(checkpoint("a")) == before);
  expect_exit(0, render(image("a"), {"--spp", "1", "--restart"}));  // nobody has asked for it now
  EXPECT_FALSE(fs::exists(checkpoint("a")));
}

// The image cannot be written at the end: what has been rendered is in the checkpoint.
TEST_F(render_loop_test, a_film_outlives_an_image_that_cannot_be_written) {
  const Arguments slow = render(image("a"), {"--time", "2", "--progress", "json", "--size", "64x64"});
  std::thread obstacle([&] {
    usleep(1200000);
    fs::remove(image("a"));
    fs::create_directories(image("a") / "full");
  });
  const ProgramResult result = run_oclair(slow);
  obstacle.join();
  EXPECT_EQ(result.exit, 1) << result.err;
  ASSERT_TRUE(fs::exists(checkpoint("a")));
  fs::remove_all(image("a"));
  expect_exit(0, render(image("a"), {"--time", "1", "--resume", "--size", "64x64"}));
  EXPECT_TRUE(fs::exists(image("a")));
}

TEST_F(render_loop_test, parts_merge_to_the_whole_render_bit_for_bit_in_any_order) {
  for (const char* sampler : {"independent", "sobol"}) {
    expect_exit(0, render(image("whole"), {"--spp", "50", "--sampler", sampler}));
    const std::pair<const char*, const char*> parts[] = {{"a", "0:16"}, {"b", "16:16"}, {"c", "48:2"}, {"d", "32:16"}};
    for (const auto& [name, samples] : parts)
      expect_exit(0, render(image(name), {"--samples", samples, "--sampler", sampler, "--restart"}));
    for (const std::string order : {"abcd", "dcba", "cadb"}) {
      Arguments merge = {"merge", "-o", image("merged").string()};
      for (const char part : order) merge.push_back(checkpoint(std::string(1, part)).string());
      expect_exit(0, merge);
      EXPECT_EQ(bytes_of(image("whole")), bytes_of(image("merged"))) << sampler << " " << order;
    }
  }
}

TEST_F(render_loop_test, what_does_not_go_together_is_not_resumed_and_the_checkpoint_stays) {
  const std::string kept = checkpoint("a").string();
  expect_exit(0, render(image("a"), {"--spp", "32", "--sampler", "sobol", "--checkpoint", kept}));
  const std::string before = bytes_of(kept);
  const std::vector<std::pair<Arguments, std::string>> wrong = {
      {{"--spp", "64"}, "expected --resume to go on with it or --restart to drop it"},
      {{"--spp", "64", "--resume", "--seed", "7"}, "seed"},
      {{"--spp", "64", "--resume", "--max-depth", "3"}, "max depth"},
      {{"--spp", "64", "--resume", "--sampler", "independent"}, "sampler"},
      {{"--spp", "64", "--resume", "--size", "16x8"}, "16x8"},
      {{"--spp", "16", "--resume"}, "expected at most the 16 that are wanted"},
      {{"--samples", "16:16", "--resume"}, "its samples begin at 0, expected 16"},
      {{"--spp", "64", "--resume", "--restart"}, "expected one of them"},
      {{"--spp", "64", "--samples", "0:64"}, "expected one of them"},
  };
  for (const auto& [options, message] : wrong) {
    const ProgramResult result = run_oclair(render(image("a"), options));
    EXPECT_TRUE(result.exit == 1 || result.exit == 2) << message << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << message << ":\n" << result.err;
    ASSERT_TRUE(bytes_of(kept) == before) << message;
  }
}

TEST_F(render_loop_test, the_limit_that_comes_first_ends_the_render_and_the_exit_code_says_whether_it_was_the_target) {
  const auto reason = [&](int exit, Arguments limits) {
    limits.insert(limits.end(), {"--progress", "json", "--restart"});
    return events_of(expect_exit(exit, render(image("a"), limits)).err).back()["reason"].get<std::string>();
  };
  EXPECT_EQ(reason(0, {"--spp", "8"}), "samples");
  EXPECT_EQ(reason(0, {"--spp", "8", "--time", "1h"}), "samples");
  EXPECT_EQ(reason(0, {"--time", "1"}), "time");
  EXPECT_EQ(reason(5, {"--time", "1", "--spp", "1000000000"}), "time");
  EXPECT_EQ(reason(5, {"--error", "1e-9", "--spp", "32"}), "samples");
  EXPECT_EQ(reason(5, {"--error", "1e-9", "--time", "1"}), "time");
  EXPECT_EQ(reason(0, {"--error", "0.9", "--time", "1h"}), "error");
}

TEST_F(render_loop_test, without_a_checkpoint_resume_begins) {
  expect_exit(0, render(image("a"), {"--spp", "4"}));
  expect_exit(0, render(image("b"), {"--spp", "4", "--resume"}));
  EXPECT_EQ(bytes_of(image("a")), bytes_of(image("b")));
}

// 128x128 pixels are 2.9 MiB: three bands and one.
TEST_F(render_loop_test, a_film_in_bands_gives_the_same_file) {
  expect_exit(0, render(image("a"), {"--spp", "17", "--size", "128x128"}));
  expect_exit(0, render(image("b"), {"--spp", "17", "--size", "128x128", "--film-memory", "1"}));
  EXPECT_EQ(bytes_of(image("a")), bytes_of(image("b")));
}

TEST_F(render_loop_test, an_image_may_have_one_pixel) { expect_exit(0, render(image("a"), {"--spp", "3", "--size", "1x1"})); }

// 16384^2 x 184 bytes are 46 GiB.
TEST_F(render_loop_test, info_plans_the_memory_of_the_largest_images) {
  const ProgramResult small = expect_exit(0, {"info", scene, "--size", "64x64"});
  EXPECT_NE(small.out.find("film                64x64"), std::string::npos) << small.out;
  EXPECT_NE(small.out.find("film                736.0 KiB in memory, all of it on the device"), std::string::npos) << small.out;
  const ProgramResult large = expect_exit(0, {"info", scene, "--size", "16384x16384"});
  EXPECT_NE(large.out.find("film                46.0 GiB in "), std::string::npos) << large.out;
}

TEST_F(render_loop_test, the_memory_is_told_before_it_is_taken) {
  const ProgramResult words = expect_exit(0, render(image("a"), {"--spp", "1", "--aov", "depth"}));
  const std::size_t told = words.err.find("memory  film: 46.0 KiB in memory, all of it on the device; layers: 1.0 KiB in memory\n");
  EXPECT_LT(told, words.err.find("kernels ")) << words.err;
  const auto events = events_of(expect_exit(0, render(image("b"), {"--spp", "1", "--progress", "json"})).err);
  const auto event = std::find_if(events.begin(), events.end(), [](const auto& e) { return e["event"] == "memory"; });
  ASSERT_NE(event, events.end());
  EXPECT_EQ((*event)["film"], 16 * 16 * 184);
  EXPECT_EQ((*event)["plan"], "film: 46.0 KiB in memory, all of it on the device");
}

// The disk is full when the error is judged for the first time: room for its pixels was not taken before.
TEST_F(render_loop_test, what_fails_between_two_passes_loses_no_sample) {
  World world;
  add_shape(world, diffuse(0.5), Sides::both, 1.0).geometry = Geometry::sphere;
  look(world, {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, 64, 64);
  const Scene placed = place_scene(world);
  const Bvh bvh = build_bvh(placed, device().bvh_width);
  Renderer renderer = start_render(device(), placed, bvh);
  ErrorMonitor monitor(0.1, 0.95, ErrorMonitor::usual_block, std::make_shared<const fs::path>(directory / ""));
  std::ostringstream messages;
  Progress progress(messages, false);
  Checkpoint state;
  std::vector<SampleRange> written;
  OnTheWay way;
  way.checkpoint_every = 3600.0;
  way.write_checkpoint = [&](const Checkpoint& now) {
    EXPECT_EQ(now.film.samples, count_samples(now.ranges));
    EXPECT_EQ(now.film.pixels.size(), 64u * 64u);
    written.insert(written.end(), now.ranges.begin(), now.ranges.end());
  };
  const FileSizeLimit full(64 * 64 * sizeof(ErrorMonitor::Pixel) - 1);
  try {
    render_until({1000, false, {}, &monitor}, renderer, state, way, progress, steady_seconds());
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
  }
  ASSERT_EQ(written.size(), 1u);
  EXPECT_EQ(written[0].count, renderer.samples);
  EXPECT_GT(renderer.samples, 0u);
}
