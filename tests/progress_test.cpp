#include "../host/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <utility>

namespace {

using oclair::format_seconds;
using oclair::Progress;

struct Screen {
  double now = 100;
  std::ostringstream text;
  Progress on(bool is_terminal) {
    return Progress(text, is_terminal, [this] { return now; });
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

TEST(progress_test, times_are_written_in_the_unit_that_fits) {
  EXPECT_EQ(format_seconds(0), "0.0 s");
  EXPECT_EQ(format_seconds(59.94), "59.9 s");
  EXPECT_EQ(format_seconds(59.96), "1:00 min");
  EXPECT_EQ(format_seconds(245), "4:05 min");
  EXPECT_EQ(format_seconds(3599.6), "1:00:00 h");
  EXPECT_EQ(format_seconds(3723), "1:02:03 h");
}

}  // namespace
