// `oclair tune` as a command: what it writes, when it refuses, how it ends.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "../host/settings_file.h"
#include "exr_reader.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path scenes = fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes";

// Arguments that measure the furnace on very small pictures, however long it takes.
std::vector<std::string> quick(std::vector<std::string> more) {
  std::vector<std::string> arguments = {"tune", (scenes / "furnace.xml").string(), "--size", "16x12", "--replicas", "4", "--budget", "1h"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// What depends on no clock: all of a row but its speed, what follows from that, and the order of the rows.
std::map<std::string, Json> rows_without_times(const Json& json) {
  std::map<std::string, Json> rows;
  for (Json row : json.at("rows")) {
    if (row.at("combination")) continue;
    for (const char* time : {"speed", "gain", "replicaSeconds", "secondsToError", "slope", "onFront"}) EXPECT_EQ(row.erase(time), 1u) << time;
    for (Json& point : row.at("curve")) point.erase("seconds");
    const std::string name = row.at("name");
    EXPECT_TRUE(rows.emplace(name, row).second) << name;
  }
  return rows;
}

bool holds(const Json& interval, double value) { return interval.at("low") <= value && value <= interval.at("high"); }

// Whether the process has a handler for it: a row of /proc/PID/status, in which bit n - 1 stands for signal n.
bool catches(pid_t process, int number) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("SigCgt:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1u;
  return false;
}

}  // namespace

TEST(tune_command_test, table_json_report_and_settings_are_written_and_render_takes_the_settings) {
  const TemporaryDirectory directory;
  const fs::path json = directory / "a.json", html = directory / "a.html", settings = directory / "s.json", exr = directory / "a.exr";
  // To half of the mean: paths of two segments, which lose a quarter, are accurate enough for that. 16 replicas are enough for the
  // intervals of the speed.
  std::vector<std::string> arguments = quick({"--error", "0.5", "--json", json.string(), "--html", html.string(), "--write", settings.string()});
  *std::find(arguments.begin(), arguments.end(), "4") = "16";
  const ProgramResult result = run_oclair(arguments);
  ASSERT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(directory.names().size(), 3u);
  const Json found = Json::parse(content(json));
  EXPECT_EQ(found.at("scene"), "furnace.xml");
  EXPECT_EQ(found.at("width"), 16);
  EXPECT_EQ(found.at("height"), 12);
  EXPECT_EQ(found.at("replicas"), 16);
  EXPECT_EQ(found.at("error"), 0.5);
  EXPECT_FALSE(found.at("interrupted"));
  EXPECT_TRUE(found.at("notMeasured").empty());
  std::set<std::string> options;
  for (const Json& row : found.at("rows")) {
    const std::string name = row.at("name");
    EXPECT_NE(result.out.find(name + " "), std::string::npos) << name << " is not in the table";
    EXPECT_NE(content(html).find(name), std::string::npos) << name << " is not in the report";
    for (const auto& [option, value] : row.at("settings").items()) options.insert(option);
    if (row.at("effect") == "none") { EXPECT_TRUE(row.at("sameBits")) << name; }
    if (row.at("sameBits")) { EXPECT_EQ(row.at("biasBound"), 0.0) << name; }
  }
  for (const char* option : {"max-depth", "rr-depth", "light-sampling", "sampler", "clamp", "bvh-width"}) EXPECT_EQ(options.count(option), 1u) << option;
  EXPECT_EQ(options.count("fresnel"), 0u);  // no glass here
  for (std::size_t at = result.out.find(')'); at != std::string::npos; at = result.out.find(')', at + 1))
    EXPECT_FALSE(std::isdigit(static_cast<unsigned char>(result.out[at + 1]))) << "two columns touch in\n" << result.out;
  // 1 + 1/2 + 1/4 ... of which N segments see all but 2^-N.
  for (const Json& row : found.at("rows"))
    for (const int depth : {2, 4, 8})
      if (row.at("name") == "max-depth=" + std::to_string(depth)) {
        EXPECT_TRUE(holds(row.at("bias"), -std::exp2(-depth))) << row.at("bias");
        EXPECT_GT(row.at("biasBound"), std::exp2(-depth));
      }

  ASSERT_TRUE(found.at("recommended").is_string());
  const oclair::SettingsFile recommended = oclair::read_settings(settings);
  EXPECT_EQ(oclair::text_of(recommended.choices), found.at("recommended").get<std::string>());
  EXPECT_NE(result.out.find("recommended: " + oclair::text_of(recommended.choices)), std::string::npos);
  EXPECT_FALSE(recommended.measured.empty());
  const ProgramResult render = run_oclair(
      {"render", (scenes / "furnace.xml").string(), "-o", exr.string(), "--spp", "2", "--size", "16x12", "--settings", settings.string()});
  EXPECT_EQ(render.exit, 0) << render.err;
  EXPECT_EQ(render.err.find("warning"), std::string::npos) << render.err;  // the scene is that of the settings
  const std::string header = std::get<std::string>(read_exr(exr).attributes.at("settings"));
  EXPECT_EQ(header.find(oclair::text_of(recommended.choices) + " bias="), 0u) << header;
  EXPECT_NE(header.find(" error=0.5 "), std::string::npos) << header;  // without it the time to it says nothing
}

// What was measured of a setting says nothing of another one.
TEST(tune_command_test, options_beside_a_settings_file_leave_its_measures_out) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "s.json", exr = directory / "a.exr";
  oclair::SettingsFile settings;
  settings.choices.max_depth = 8;
  settings.measured = {{"bias", "-0.001"}, {"biasBound", "0.002"}};
  oclair::write_settings(file, settings);
  const auto render = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", (scenes / "furnace.xml").string(), "-o", exr.string(), "--spp", "1", "--size", "8x8", "--settings", file.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    return std::pair(result.err, std::get<std::string>(read_exr(exr).attributes.at("settings")));
  };
  const std::string said = "the options of the command line make it max-depth=1";
  const auto [quiet, measured] = render({"--max-depth", "8"});  // as the file has it
  EXPECT_EQ(quiet.find("the options of the command line"), std::string::npos) << quiet;
  EXPECT_EQ(measured.find("max-depth=8 bias=-0.001 biasBound=0.002 of "), 0u) << measured;
  const auto [same_samples, still_measured] = render({"--kernels", "exact"});
  EXPECT_EQ(same_samples.find("the options of the command line"), std::string::npos) << same_samples;
  EXPECT_EQ(still_measured.find("max-depth=8 bias=-0.001 "), 0u) << still_measured;
  const auto [warned, changed] = render({"--max-depth", "1"});
  EXPECT_NE(warned.find(said), std::string::npos) << warned;
  EXPECT_EQ(changed.find("max-depth=8 changed to max-depth=1 of "), 0u) << changed;
  EXPECT_EQ(changed.find("bias"), std::string::npos) << changed;
}

TEST(tune_command_test, what_depends_on_no_clock_is_the_same_again) {
  const ProgramResult first = run_oclair(quick({"--json", "-"})), second = run_oclair(quick({"--json", "-"}));
  ASSERT_EQ(first.exit, 0) << first.err;
  ASSERT_EQ(second.exit, 0) << second.err;
  const Json a = Json::parse(first.out), b = Json::parse(second.out);  // nothing else goes there
  EXPECT_NE(first.err.find("recommended: "), std::string::npos);
  const auto rows = rows_without_times(a);
  EXPECT_GT(rows.size(), 8u);
  EXPECT_EQ(rows, rows_without_times(b));
  EXPECT_EQ(a.at("accurate").at("replicaVariance"), b.at("accurate").at("replicaVariance"));
  for (const char* name : {"program", "scene", "sceneHash", "device", "width", "height", "confidence"}) EXPECT_EQ(a.at(name), b.at(name));
}

TEST(tune_command_test, wrong_values_are_refused_with_what_was_expected) {
  const std::pair<const char*, const char*> wrong[] = {
      {"--error", "0"}, {"--error", "-1"}, {"--error", "nan"}, {"--error", "inf"}, {"--error", "much"}, {"--confidence", "0"}, {"--confidence", "1"},
      {"--confidence", "0.99999999999999999999"}, {"--confidence", "95"}, {"--budget", "soon"}, {"--budget", "-5s"}, {"--replicas", "3"},
      {"--replicas", "4097"}, {"--replicas", "4.5"}, {"--size", "16"}, {"--size", "0x16"}, {"--size", "16x"}};
  for (const auto& [option, value] : wrong) {
    const ProgramResult result = run_oclair({"tune", (scenes / "furnace.xml").string(), option + ("=" + std::string(value))});
    EXPECT_EQ(result.exit, 2) << option << " " << value;
    EXPECT_NE(result.err.find(option), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("expected"), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_EQ(run_oclair({"tune"}).exit, 2);
  EXPECT_EQ(run_oclair({"tune", (scenes / "furnace.xml").string(), "--fresnel", "schlick"}).exit, 2);  // it is tune that varies them
}

TEST(tune_command_test, a_scene_that_is_not_there_is_told) {
  const TemporaryDirectory directory;
  const ProgramResult result = run_oclair({"tune", (directory / "none.xml").string(), "--json", (directory / "a.json").string()});
  EXPECT_EQ(result.exit, 3);
  EXPECT_NE(result.err.find("none.xml"), std::string::npos) << result.err;
  EXPECT_TRUE(directory.names().empty());
}

// Before anything is rendered: an accurate setting is told of first.
TEST(tune_command_test, files_that_cannot_be_written_are_told_before_the_work) {
  const TemporaryDirectory directory;
  for (const char* option : {"--json", "--html", "--write"}) {
    const std::string nowhere = (directory / "none" / "file").string();
    const ProgramResult result = run_oclair(quick({option, nowhere}));
    EXPECT_EQ(result.exit, 1) << option;
    EXPECT_NE(result.err.find(nowhere), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("accurate"), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST(tune_command_test, outputs_take_neither_each_others_place_nor_the_scenes) {
  const TemporaryDirectory directory;
  const fs::path scene = directory / "scene.xml", one = directory / "one";
  fs::copy(scenes / "furnace.xml", scene);
  const std::string before = content(scene);
  const std::vector<std::vector<std::string>> cases = {{"--json", scene.string()}, {"--html", scene.string()}, {"--write", scene.string()},
                                                       {"--json", one.string(), "--html", one.string()},
                                                       {"--html", one.string(), "--write", (directory / "." / "one").string()}};
  for (std::vector<std::string> arguments : cases) {
    const std::string last = arguments.back();
    arguments.insert(arguments.begin(), {"tune", scene.string(), "--size", "16x12", "--replicas", "4", "--budget", "1s"});
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 2) << last;
    EXPECT_NE(result.err.find("expected a file of its own"), std::string::npos) << result.err;
    EXPECT_EQ(content(scene), before);
  }
}

// What the scene's file names is the scene's as well.
TEST(tune_command_test, meshes_and_textures_of_the_scene_are_not_written_over) {
  const TemporaryDirectory directory;
  const fs::path scene = directory / "scene.xml", mesh = directory / "mesh.obj";
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  put(mesh, vertices);
  put(scene, "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"/><emitter type=\"constant\"/>"
             "<shape type=\"obj\"><string name=\"filename\" value=\"mesh.obj\"/></shape></scene>");
  for (const char* option : {"--json", "--html", "--write"}) {
    const ProgramResult result = run_oclair({"tune", scene.string(), "--size", "16x12", "--replicas", "4", "--budget", "1s", option, mesh.string()});
    EXPECT_EQ(result.exit, 2) << result.err;
    EXPECT_NE(result.err.find("expected a file of its own"), std::string::npos) << result.err;
    EXPECT_EQ(content(mesh), vertices);
  }
}

// Nothing is recommended that has not been measured.
TEST(tune_command_test, a_budget_too_short_for_one_setting_is_told_and_writes_nothing) {
  const TemporaryDirectory directory;
  const fs::path settings = directory / "s.json";
  const std::vector<std::vector<std::string>> cases = {{"--size", "16x12"}, {}};  // the film as it is asked for, and as the budget allows
  for (std::vector<std::string> arguments : cases) {
    arguments.insert(arguments.begin(), {"tune", (scenes / "furnace.xml").string(), "--replicas", "4", "--budget", "0.01s", "--write", settings.string()});
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 5) << result.err;
    EXPECT_NE(result.err.find("expected --budget "), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(directory.names().empty());
  }
}

TEST(tune_command_test, pictures_that_do_not_fit_into_memory_are_refused_before_they_are_rendered) {
  const ProgramResult result = run_oclair({"tune", (scenes / "furnace.xml").string(), "--size", "16384x16384", "--replicas", "4096"});
  EXPECT_EQ(result.exit, 4) << result.err;
  EXPECT_NE(result.err.find("4096 replicas of 16384x16384 pixels take "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("expected at most "), std::string::npos) << result.err;
}

// As soon as it has a handler for it; then it is asked between two pictures, so that at worst one of them is waited for.
TEST(tune_command_test, an_interrupted_one_says_so_and_recommends_nothing_in_a_file) {
  const TemporaryDirectory directory;
  const fs::path settings = directory / "s.json";
  const ProgramResult result = run_oclair(
      {"tune", (scenes / "furnace.xml").string(), "--size", "16x12", "--replicas", "4096", "--budget", "10h", "--write", settings.string()},
      [](pid_t process) {
        while (!catches(process, SIGINT) && !has_ended(process)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(process, SIGINT);
      });
  EXPECT_EQ(result.exit, 5) << result.err;
  EXPECT_FALSE(fs::exists(settings));
}
