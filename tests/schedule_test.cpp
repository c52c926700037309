#include "../host/schedule.h"

#include <gtest/gtest.h>

#include <vector>

namespace {

using oclair::parse_duration;
using oclair::Schedule;

// A render whose samples take so many seconds each.
struct Render {
  Schedule::Limits limits;
  double seconds_per_sample = 0.01;
  double now = 1000;
  std::uint64_t done = 0;
  std::vector<unsigned> passes = {};

  Schedule schedule(double phases_before = 0) {
    return Schedule(limits, [this] { return now; }, now - phases_before);
  }
  bool pass(Schedule& schedule) {
    const unsigned samples = schedule.next_pass(done);
    if (samples == 0) return false;
    now += samples * seconds_per_sample;
    schedule.pass_ended(samples);
    done += samples;
    passes.push_back(samples);
    return true;
  }
};

constexpr std::uint64_t without_end = std::uint64_t{1} << 33;

TEST(schedule_test, durations_are_seconds_minutes_or_hours) {
  EXPECT_EQ(parse_duration("90s"), 90.0);
  EXPECT_EQ(parse_duration("30"), 30.0);
  EXPECT_EQ(parse_duration("2m"), 120.0);
  EXPECT_EQ(parse_duration("1.5h"), 5400.0);
  EXPECT_EQ(parse_duration("0.25"), 0.25);
  EXPECT_EQ(parse_duration("1e9"), 1e9);
}

TEST(schedule_test, what_is_no_duration_gives_nothing) {
  for (const char* text : {"", "s", "h", "0", "0s", "-1", "-1h", "1d", "1hm", "90 seconds", "1h30m", "nan", "inf", "1e10", "1e300h",
                           "1e999", "ten"})
    EXPECT_EQ(parse_duration(text), std::nullopt) << text;
}

TEST(schedule_test, passes_grow_to_16_samples_and_end_at_the_target) {
  Render render{{100, {}, {}}};
  Schedule schedule = render.schedule();
  while (render.pass(schedule)) {
  }
  EXPECT_EQ(render.passes, (std::vector<unsigned>{1, 1, 2, 4, 8, 16, 16, 16, 16, 16, 4}));
  EXPECT_EQ(render.done, 100u);
}

TEST(schedule_test, a_resumed_render_comes_to_multiples_of_16_again) {
  for (std::uint64_t before = 0; before < 40; ++before) {
    Render render{{200, {}, {}}};
    render.done = before;
    Schedule schedule = render.schedule();
    std::uint64_t multiple = before / 16 * 16;  // the last one that was met, or passed before the start
    while (render.pass(schedule)) {
      EXPECT_LE(render.done, multiple + 16) << before;
      if (render.done == multiple + 16) multiple = render.done;
    }
    EXPECT_EQ(render.done, 200u);
    EXPECT_EQ(render.passes.front(), 1u);
  }
}

TEST(schedule_test, no_pass_is_taken_where_nothing_is_wanted) {
  Render render{{64, {}, {}}};
  render.done = 64;
  Schedule schedule = render.schedule();
  EXPECT_EQ(schedule.next_pass(64), 0u);
  EXPECT_EQ(schedule.next_pass(65), 0u);
}

TEST(schedule_test, a_time_limit_is_met_to_within_a_sample_for_samples_of_any_length) {
  for (const double seconds_per_sample : {1e-5, 0.003, 0.7, 3.0, 20.0}) {
    Render render{{without_end, 60.0, {}}};
    render.seconds_per_sample = seconds_per_sample;
    Schedule schedule = render.schedule(5.0);
    const double started = render.now - 5.0;
    while (render.pass(schedule)) {
    }
    EXPECT_NEAR(render.now - started, 60.0, 0.5 * seconds_per_sample + 1e-6) << seconds_per_sample;
    EXPECT_NEAR(schedule.seconds_left().value(), std::max(0.0, started + 60.0 - render.now), 1e-6);
  }
}

TEST(schedule_test, a_render_takes_one_sample_even_when_its_time_was_over_before) {
  Render render{{without_end, 1.0, {}}};
  Schedule schedule = render.schedule(100.0);
  EXPECT_TRUE(render.pass(schedule));
  EXPECT_FALSE(render.pass(schedule));
  EXPECT_EQ(render.done, 1u);
}

TEST(schedule_test, the_time_of_writing_is_kept_free_at_the_end) {
  Render render{{without_end, 60.0, 10.0}};
  Schedule schedule = render.schedule();
  schedule.picture_written(4.0);
  schedule.checkpoint_written(3.0);
  while (render.pass(schedule)) {
    if (schedule.picture_due()) schedule.picture_written(4.0);
    if (schedule.checkpoint_due()) schedule.checkpoint_written(3.0);
  }
  EXPECT_NEAR(render.now - 1000.0, 53.0, 0.01);
}

TEST(schedule_test, pictures_come_after_2_seconds_and_then_at_doubling_intervals) {
  Render render{{without_end, {}, {}}};
  Schedule schedule = render.schedule();
  std::vector<double> pictures;
  while (render.now < 1000 + 150) {
    render.pass(schedule);
    if (schedule.picture_due()) {
      render.now += 1.0;  // writing takes a while: the next interval begins afterwards
      schedule.picture_written(1.0);
      pictures.push_back(render.now);
    }
  }
  ASSERT_EQ(pictures.size(), 6u);
  EXPECT_NEAR(pictures[0], 1003.0, 0.02);
  for (std::size_t i = 1; i < pictures.size(); ++i) EXPECT_NEAR(pictures[i] - pictures[i - 1], (2 << i) + 1.0, 0.02);
}

TEST(schedule_test, checkpoints_come_every_n_seconds_whatever_a_pass_of_16_samples_takes) {
  Render render{{without_end, {}, 3.0}};
  render.seconds_per_sample = 0.8;
  Schedule schedule = render.schedule();
  double before = render.now;
  int checkpoints = 0;
  while (render.now < 1100) {
    render.pass(schedule);
    if (!schedule.checkpoint_due()) continue;
    EXPECT_LE(render.now - before, 3.0 + 0.8);
    before = render.now;
    schedule.checkpoint_written(0.0);
    ++checkpoints;
  }
  EXPECT_GE(checkpoints, 25);
}

TEST(schedule_test, without_a_checkpoint_none_is_due) {
  Render render{{without_end, {}, {}}};
  Schedule schedule = render.schedule();
  render.now += 1e6;
  EXPECT_FALSE(schedule.checkpoint_due());
  EXPECT_EQ(schedule.seconds_left(), std::nullopt);
}

TEST(schedule_test, passes_of_slow_samples_stay_short) {
  Render render{{without_end, {}, {}}};
  render.seconds_per_sample = 2.0;
  render.now = 0;
  Schedule schedule = render.schedule();
  for (int i = 0; i < 20; ++i) render.pass(schedule);
  for (const unsigned samples : render.passes) EXPECT_LE(samples, 2u);
}

TEST(schedule_test, a_clock_that_is_set_back_brings_neither_a_flood_of_writing_nor_a_limit_that_never_comes) {
  Render render{{without_end, 100.0, 10.0}};
  Schedule schedule = render.schedule();
  int pictures = 0, checkpoints = 0, passes = 0;
  double true_seconds = 0;
  for (; render.pass(schedule); ++passes) {
    true_seconds += render.passes.back() * render.seconds_per_sample;
    if (schedule.picture_due()) ++pictures, schedule.picture_written(0);
    if (schedule.checkpoint_due()) ++checkpoints, schedule.checkpoint_written(0);
    if (passes % 100 == 50) render.now -= 1e5;
    ASSERT_LT(passes, 100000);
  }
  EXPECT_NEAR(true_seconds, 100.0, 0.1);
  EXPECT_EQ(pictures, 5);  // after 2, 6, 14, 30, 62 s
  EXPECT_EQ(checkpoints, 9);
}

}  // namespace
