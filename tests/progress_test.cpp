#include "../host/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

namespace {

using nlohmann::json;
using oclair::format_seconds;
using oclair::Progress;

struct Screen {
  double now = 100;
  std::ostringstream text;
  Progress on(bool is_terminal) {
    return Progress(text, is_terminal, [this] { return now; });
  }
  Progress json_lines() {
    return Progress::json(text, [this] { return now; });
  }
  // Every line parsed back; throws where one is not a JSON object on its own.
  std::vector<json> events() const {
    std::vector<json> all;
    std::istringstream lines(text.str());
    for (std::string line; std::getline(lines, line);) all.push_back(json::parse(line));
    return all;
  }
  // What the last line shows: the text behind the last return to its start.
  std::string last_line() const {
    const std::string all = text.str(), home = "\r\x1b[K";
    const std::size_t at = all.rfind(home);
    return at == std::string::npos ? all : all.substr(at + home.size());
  }
};

TEST(progress_test, a_phase_off_a_terminal_is_one_line_that_begins_when_it_begins) {
  Screen screen;
  Progress progress = screen.on(false);
  progress.begin("parse");
  EXPECT_EQ(screen.text.str(), "parse   ");
  screen.now += 1.25;
  progress.begin("passes");
  for (int done = 1; done <= 1000; ++done) {
    screen.now += 0.01;
    progress.samples(done * 1000, 1000000);
  }
  progress.end();
  EXPECT_EQ(screen.text.str(), "parse   1.2 s\npasses  10.0 s  100.00 ksamples/s\n");
}

TEST(progress_test, a_bar_shows_share_rate_and_time_left) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  screen.now += 10;
  progress.samples(25000000, 100000000);
  EXPECT_EQ(screen.last_line(), "passes  [######..................]  25 %  2.50 Msamples/s  30.0 s left");
  EXPECT_EQ(screen.text.str().find('\n'), std::string::npos);
  screen.now += 30;
  progress.samples(100000000, 100000000);
  EXPECT_EQ(screen.last_line(), "passes  [########################] 100 %  2.50 Msamples/s  0.0 s left");
  progress.end();
  EXPECT_EQ(screen.last_line(), "passes  40.0 s  2.50 Msamples/s\n");
}

TEST(progress_test, a_bar_is_drawn_ten_times_a_second_at_most) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  for (int done = 1; done <= 10000; ++done) {
    screen.now += 1e-4;
    progress.samples(done, 10000);
  }
  const std::string text = screen.text.str();
  EXPECT_LE(std::count(text.begin(), text.end(), '\r'), 11);
}

TEST(progress_test, a_bar_survives_amounts_that_make_no_sense) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  for (const auto& [done, total] : {std::pair{0, 0}, {5, 0}, {0, 5}, {7, 5}}) {
    screen.now += 1;
    progress.samples(done, total);
    EXPECT_EQ(screen.last_line().find("nan"), std::string::npos);
    EXPECT_EQ(screen.last_line().find("inf"), std::string::npos);
    EXPECT_LT(screen.last_line().size(), 80u);
  }
}

TEST(progress_test, a_phase_that_is_left_by_an_exception_ends_its_line) {
  Screen screen;
  { Progress(screen.on(false)).begin("kernels"); }
  EXPECT_EQ(screen.text.str(), "kernels \n");
}

TEST(progress_test, a_line_between_phases_has_a_line_of_its_own) {
  Screen screen;
  Progress progress = screen.on(false);
  progress.begin("parse");
  progress.end();
  progress.end();
  screen.text << "a.xml:3: warning\n";
  progress.begin("write");
  progress.end();
  EXPECT_EQ(screen.text.str(), "parse   0.0 s\na.xml:3: warning\nwrite   0.0 s\n");
}

TEST(progress_test, a_warning_has_a_line_of_its_own_and_the_phase_goes_on_below_it) {
  Screen screen;
  Progress progress = screen.on(false);
  progress.begin("passes");
  progress.warning("the viewer went away");
  progress.end();
  progress.warning("late");
  EXPECT_EQ(screen.text.str(),
            "passes  \noclair: warning: the viewer went away\npasses  0.0 s\noclair: warning: late\n");
}

TEST(progress_test, a_warning_on_a_terminal_takes_the_place_of_the_bar) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  progress.warning("the viewer went away");
  EXPECT_EQ(screen.text.str(), "\r\x1b[Kpasses  \r\x1b[Koclair: warning: the viewer went away\n\r\x1b[Kpasses  ");
}

TEST(progress_test, without_a_number_of_samples_as_target_there_is_no_bar) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  screen.now += 10;
  progress.samples(25000000, std::nullopt, {.rays = {}, .error = 0.01234, .seconds_left = 80.0});
  EXPECT_EQ(screen.last_line(), "passes    2.50 Msamples/s  error 0.012  1:20 min left");
}

TEST(progress_test, of_two_limits_the_time_of_the_nearer_one_is_shown) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes");
  screen.now += 10;
  progress.samples(25, 100, {.rays = {}, .error = {}, .seconds_left = 7.0});
  EXPECT_NE(screen.last_line().find("  7.0 s left"), std::string::npos);
  screen.now += 1;
  progress.samples(99, 100, {.rays = {}, .error = {}, .seconds_left = 7.0});
  EXPECT_NE(screen.last_line().find("  0.1 s left"), std::string::npos);
}

TEST(progress_test, samples_of_an_earlier_run_count_in_the_share_but_not_in_the_rate) {
  Screen screen;
  Progress progress = screen.on(true);
  progress.begin("passes", 50);
  screen.now += 10;
  progress.samples(75, 100);
  EXPECT_EQ(screen.last_line(), "passes  [##################......]  75 %  2.50 samples/s  10.0 s left");
}

TEST(progress_test, json_events_parse_back_to_what_happened) {
  Screen screen;
  {
    Progress progress = screen.json_lines();
    progress.begin("parse");
    screen.now += 1.25;
    progress.warning("a \"quoted\"\nline, and no UTF-8: \xff");
    progress.begin("passes", 1000);
    screen.now += 2;
    progress.samples(5000, 9000, {.rays = 14000, .error = 0.125, .seconds_left = {}});
    progress.wrote_file("a b.exr");
    progress.wrote_checkpoint("a b.checkpoint");
    screen.now += 2;
    progress.finish("samples", 0);
  }
  const std::vector<json> expected{
      {{"event", "begin"}, {"seconds", 0.0}, {"phase", "parse"}},
      {{"event", "warning"}, {"seconds", 1.25}, {"message", "a \"quoted\"\nline, and no UTF-8: \xef\xbf\xbd"}},
      {{"event", "end"}, {"seconds", 1.25}, {"phase", "parse"}, {"duration", 1.25}},
      {{"event", "begin"}, {"seconds", 1.25}, {"phase", "passes"}},
      {{"event", "samples"}, {"seconds", 3.25}, {"phase", "passes"}, {"done", 5000}, {"wanted", 9000},
       {"samples_per_second", 2000.0}, {"rays_per_second", 7000.0}, {"error", 0.125}, {"seconds_left", 2.0}},
      {{"event", "file"}, {"seconds", 3.25}, {"path", "a b.exr"}},
      {{"event", "checkpoint"}, {"seconds", 3.25}, {"path", "a b.checkpoint"}},
      {{"event", "end"}, {"seconds", 5.25}, {"phase", "passes"}, {"duration", 4.0}, {"done", 5000}, {"samples_per_second", 1000.0}},
      {{"event", "finish"}, {"seconds", 5.25}, {"reason", "samples"}, {"exit", 0}}};
  EXPECT_EQ(screen.events(), expected);
}

TEST(progress_test, json_says_null_where_nothing_is_known_and_never_a_value_that_json_lacks) {
  Screen screen;
  {
    Progress progress = screen.json_lines();
    progress.begin("passes");
    screen.now += 1;
    progress.samples(0, std::nullopt);
    screen.now += 1;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    progress.samples(1ull << 61, 1ull << 61, {.rays = {}, .error = infinity, .seconds_left = std::nan("")});
  }
  const std::vector<json> events = screen.events();
  ASSERT_EQ(events.size(), 4u);
  for (const char* name : {"wanted", "samples_per_second", "rays_per_second", "error", "seconds_left"}) {
    EXPECT_TRUE(events[1].at(name).is_null()) << name;
  }
  EXPECT_EQ(events[2].at("done"), 1ull << 61);
  EXPECT_EQ(events[2].at("wanted"), 1ull << 61);
  EXPECT_TRUE(events[2].at("error").is_null());
  EXPECT_EQ(events[3], (json{{"event", "finish"}, {"seconds", 2.0}, {"reason", "failed"}, {"exit", nullptr}}));
}

TEST(progress_test, json_tells_of_samples_once_a_second_at_most) {
  Screen screen;
  {
    Progress progress = screen.json_lines();
    progress.begin("passes");
    for (int done = 1; done <= 10000; ++done) {
      screen.now += 1e-3;
      progress.samples(done, 10000);
    }
    progress.finish("samples", 0);
  }
  double before = 0;
  int told = 0;
  for (const json& event : screen.events()) {
    if (event.at("event") != "samples") continue;
    EXPECT_GE(event.at("seconds").get<double>() - before, 0.999);
    before = event.at("seconds");
    ++told;
  }
  EXPECT_GE(told, 9);
  EXPECT_LE(told, 10);
}

TEST(progress_test, times_are_written_in_the_unit_that_fits) {
  EXPECT_EQ(format_seconds(0), "0.0 s");
  EXPECT_EQ(format_seconds(59.94), "59.9 s");
  EXPECT_EQ(format_seconds(59.96), "1:00 min");
  EXPECT_EQ(format_seconds(245), "4:05 min");
  EXPECT_EQ(format_seconds(3599.6), "1:00:00 h");
  EXPECT_EQ(format_seconds(3723), "1:02:03 h");
}

}  // namespace
