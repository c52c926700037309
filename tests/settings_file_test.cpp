// The settings file: what is written is read again, and what is wrong with one is told with its line.
#include "../host/settings_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>

#include "../host/error.h"
#include "files.h"
#include "temporary_directory.h"

using namespace oclair;

namespace {

// Some values of each option, the ends of their ranges among them.
const std::vector<std::string>& values_of(const Choice& choice) {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> all = {
      {"fresnel", {"exact", "schlick"}},
      {"oren-nayar", {"full", "qualitative"}},
      {"max-depth", {"0", "1", "8", "4294967295"}},
      {"rr-depth", {"1", "5", "4294967295"}},
      {"light-sampling", {"both", "bsdf"}},
      {"sampler", {"independent", "sobol"}},
      {"clamp", {"1.1754944e-38", "0.1", "0.33333334", "7", "1e+20", "3.4028235e+38"}},
      {"kernels", {"shared", "exact"}},
      {"arithmetic", {"float", "double"}},
      {"bvh-width", {"4", "8"}}};
  static const std::vector<std::string> none;
  for (const auto& [name, values] : all)
    if (name == choice.name) return values;
  return none;
}

SettingsFile full() {
  SettingsFile settings;
  settings.program = "oclair 9.9";
  settings.scene = "a \"scene\"\n.xml";
  settings.scene_hash = "0123456789abcdef";
  settings.measured = {{"bias", "-0.0012"}, {"biasBound", "0.003"}, {"confidence", "0.95"}, {"error", "0.02"}, {"speed", "1.25"}};
  for (const Choice& choice : choices()) choice.set(settings.choices, values_of(choice).back(), choice.name);
  return settings;
}

class settings_file_test : public testing::Test {
 protected:
  SettingsFile read(const std::string& text) {
    put(file, text);
    return read_settings(file);
  }

  // What is said of the text, without the file's name.
  std::string refusal(const std::string& text) {
    put(file, text);
    return refusal();
  }
  std::string refusal() {
    try {
      read_settings(file);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::scene);
      const std::string message = error.what();
      EXPECT_EQ(message.find(file.string() + ":"), 0u) << message;
      EXPECT_NE(message.find("expected"), std::string::npos) << message;
      for (const char c : message) EXPECT_TRUE(static_cast<unsigned char>(c) >= ' ' && c != '\x7f') << message;
      EXPECT_LT(message.size(), file.string().size() + 400) << message;
      return message.substr(std::min(message.size(), file.string().size()));
    }
    return "not refused";
  }
  void expect_refused(const std::string& text, int line, const std::string& part) {
    const std::string message = refusal(text);
    EXPECT_EQ(message.find(":" + std::to_string(line) + ": "), 0u) << text.substr(0, 200) << "\n" << message;
    EXPECT_NE(message.find(part), std::string::npos) << text.substr(0, 200) << "\n" << message;
  }

  const TemporaryDirectory directory;
  const std::filesystem::path file = directory / "settings.json";
};

// One setting, whose value stands in line 3.
std::string setting(const std::string& name, const std::string& value) { return "{\n\"settings\": {\n\"" + name + "\": " + value + "\n}\n}\n"; }

}  // namespace

TEST_F(settings_file_test, every_value_of_every_option_is_read_as_it_was_written) {
  std::set<std::string> seen;
  for (const Choice& choice : choices()) {
    ASSERT_FALSE(values_of(choice).empty()) << choice.name << " is new: give some values of it here";
    EXPECT_TRUE(seen.insert(choice.name).second) << choice.name;
    for (const std::string& value : values_of(choice)) {
      SettingsFile settings;
      choice.set(settings.choices, value, choice.name);
      EXPECT_EQ(choice.get(settings.choices), value) << choice.name;
      write_settings(file, settings);
      const Choices again = read_settings(file).choices;
      for (const Choice& other : choices()) EXPECT_EQ(other.get(again), other.get(settings.choices)) << other.name;
      EXPECT_EQ(text_of(again), choice.name + ("=" + value));
    }
  }
}

TEST_F(settings_file_test, all_that_is_written_is_read_again) {
  const SettingsFile before = full();
  write_settings(file, before);
  const SettingsFile after = read_settings(file);
  EXPECT_EQ(after.program, before.program);
  EXPECT_EQ(after.scene, before.scene);
  EXPECT_EQ(after.scene_hash, before.scene_hash);
  EXPECT_EQ(text_of(after.choices), text_of(before.choices));
  EXPECT_EQ(after.measured, before.measured);
  const std::string text = content(file);
  write_settings(file, after);
  EXPECT_EQ(content(file), text);
}

TEST_F(settings_file_test, a_measure_that_is_no_number_is_left_out) {
  SettingsFile settings = full();
  settings.measured.insert(settings.measured.begin(), {{"speed", "inf"}, {"variance", "nan"}, {"timeToEqualError", ""}});
  write_settings(file, settings);
  EXPECT_EQ(read_settings(file).measured, full().measured);
}

TEST_F(settings_file_test, what_is_not_said_is_not_chosen) {
  for (const char* text : {"{}", "{\"settings\": {}}", " { \"program\" : \"x\" } \n"}) EXPECT_EQ(text_of(read(text).choices), "none");
  write_settings(file, {});
  EXPECT_EQ(text_of(read_settings(file).choices), "none");
}

// As a user writes them by hand.
TEST_F(settings_file_test, numbers_may_stand_without_quotes) {
  const Choices chosen = read("{\"settings\": {\"max-depth\": 8, \"clamp\": 0.5, \"bvh-width\": 4}}").choices;
  EXPECT_EQ(text_of(chosen), "max-depth=8 clamp=0.5 bvh-width=4");
}

TEST_F(settings_file_test, unknown_names_are_refused_with_those_that_are_known) {
  expect_refused("{\n\"prog\": \"x\"\n}", 2, "\"prog\"");
  expect_refused("{\n\n\n\"measure\": {\"bias\": 1}}", 4, "measure");
  expect_refused(setting("fresnell", "\"exact\""), 3, "fresnell");
  for (const Choice& choice : choices()) EXPECT_NE(refusal(setting("x", "1")).find(choice.name), std::string::npos) << choice.name;
  expect_refused(setting("", "1"), 3, "\"\"");
  expect_refused(setting("Fresnel", "\"exact\""), 3, "Fresnel");
  expect_refused(setting("clamp\\u0000", "\"1\""), 3, "clamp?");
  expect_refused(setting("\\u001b[31mred\\n", "\"1\""), 3, "?[31mred?");
  expect_refused("{\"measured\": {\n\"biass\": 1}}", 2, "biass");
  for (const char* name : {"setings", "", "Settings", "program"})  // of an object, whatever it holds
    expect_refused("{\n\"" + std::string(name) + "\": {}}", 2, "unknown object \"" + std::string(name) + "\"");
}

TEST_F(settings_file_test, wrong_values_are_refused_with_those_that_are_right) {
  for (const Choice& choice : choices())
    for (const std::string value : {"\"\"", "\"none\"", "\"-1\"", "-1", "\"1e400\"", "\"nan\"", "\"inf\"", "0.1e-40", "\"0x8\""}) {
      const std::string message = refusal(setting(choice.name, value));
      EXPECT_EQ(message.find(":3: " + std::string(choice.name) + " '"), 0u) << choice.name << " " << value << " " << message;
    }
  expect_refused(setting("fresnel", "\"Exact\""), 3, "exact or schlick");
  expect_refused(setting("light-sampling", "\"light\""), 3, "both or bsdf");
  expect_refused(setting("max-depth", "4294967296"), 3, "4294967295");
  expect_refused(setting("max-depth", "18446744073709551617"), 3, "4294967295");
  expect_refused(setting("max-depth", "8.5"), 3, "whole number");
  expect_refused(setting("rr-depth", "0"), 3, "1 to");
  expect_refused(setting("clamp", "0"), 3, "number");
  expect_refused(setting("clamp", "1e39"), 3, "number");
  expect_refused(setting("bvh-width", "16"), 3, "4 or 8");
  expect_refused("{\"measured\": {\n\"bias\": \"small\"}}", 2, "small");
}

TEST_F(settings_file_test, values_that_are_neither_text_nor_numbers_are_refused) {
  for (const char* value : {"null", "true", "false", "[]", "[8]", "[[[[]]]]", "{}", "{\"x\": 1}"}) {
    const std::string message = refusal(setting("max-depth", value));
    EXPECT_EQ(message.find(":3: "), 0u) << value << " " << message;
  }
  for (const char* text : {"null", "true", "8", "\"settings\"", "[]", "[{\"settings\": {}}]"}) {
    const std::string message = refusal(text);
    EXPECT_EQ(message.find(":1: "), 0u) << text << " " << message;
  }
  expect_refused("{\n\"settings\": \"fast\"}", 2, "settings");
  expect_refused("{\n\"program\": {\"name\": \"x\"}}", 2, "program");
}

TEST_F(settings_file_test, a_name_stands_once) {
  expect_refused("{\"settings\": {\n\"clamp\": 1,\n\"max-depth\": 1,\n\"clamp\": 1}}", 4, "line 2");
  expect_refused("{\"settings\": {\"clamp\": 1},\n\"settings\": {\"clamp\": 2}}", 2, "line 1");
  expect_refused("{\"settings\": {},\n\"settings\": {}}", 2, "line 1");
  expect_refused("{\"settings\": {\"clamp\": 1},\n\"settings\": {\"fresnel\": \"exact\"}}", 2, "line 1");
  expect_refused("{\"scene\": \"a\",\n\n\"scene\": \"a\"}", 3, "line 1");
  expect_refused("{\"measured\": {\"bias\": 1,\n\"bias\": 1}}", 2, "line 1");
}

TEST_F(settings_file_test, what_is_no_json_is_refused_where_it_breaks) {
  expect_refused("", 1, "JSON");
  expect_refused("fresnel=schlick\n", 1, "JSON");
  expect_refused("{\n\"settings\": {\n\"clamp\": 1,\n}\n}", 4, "JSON");
  expect_refused("{\n\"settings\": {\n\"clamp\" 1\n}\n}", 3, "JSON");
  expect_refused("{\n\"settings\": {\n'clamp': 1\n}\n}", 3, "JSON");
  expect_refused("{\"settings\": {}} {}", 1, "JSON");
  expect_refused("{\"settings\": {}\n", 1, "JSON");  // the end is that of the last line
  expect_refused("{\"program\": \"\xff\xfe\"}", 1, "JSON");
  expect_refused(std::string("{\0}", 3), 1, "JSON");
  expect_refused("{\"settings\": {\"clamp\": 1e999}}", 1, "JSON");
  expect_refused("\x7f" "ELF\x01", 1, "JSON");
}

// Every beginning of a file is refused, in one of its lines, and nothing else happens.
TEST_F(settings_file_test, a_file_cut_off_anywhere_is_refused) {
  write_settings(file, full());
  const std::string text = content(file);
  const std::size_t end = text.find_last_of('}');
  for (std::size_t length = 0; length < end; ++length) {
    const std::string message = refusal(text.substr(0, length));
    EXPECT_NE(message.find(": is no JSON"), std::string::npos) << length << " " << message;
  }
  EXPECT_EQ(text_of(read(text.substr(0, end + 1)).choices), text_of(full().choices));
}

TEST_F(settings_file_test, depth_costs_no_stack) {
  for (const char* nested : {"[", "{\"a\":", "{\"settings\":"}) {
    std::string text;
    while (text.size() < (1 << 20) - 20) text += nested;
    EXPECT_EQ(refusal(text).find(":1: "), 0u);
  }
}

// 1 MiB of different names, and then the first one again. (Where each is held against all before it, this takes some 10 s.)
TEST_F(settings_file_test, as_many_names_as_a_file_holds_are_told_apart) {
  std::string text = "{\"measured\": {\n";
  for (int i = 0; text.size() < (1 << 20) - 30; ++i) text += "\"" + std::to_string(i) + "\":0,";
  expect_refused(text + "\"x\":0}}", 2, "unknown measure");
  expect_refused(text + "\n\"0\":0}}", 3, "line 2");
}

TEST_F(settings_file_test, files_that_cannot_be_settings_are_refused) {
  EXPECT_NE(refusal().find("cannot be read"), std::string::npos);  // there is none
  std::filesystem::create_directory(file);
  EXPECT_NE(refusal().find("is no regular file"), std::string::npos);
  std::filesystem::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);  // nobody will ever write into it
  EXPECT_NE(refusal().find("is no regular file"), std::string::npos);
  std::filesystem::remove(file);
  const std::string spaces((1 << 20) - 2, ' ');
  EXPECT_EQ(text_of(read("{}" + spaces).choices), "none");
  EXPECT_NE(refusal("{}" + spaces + " ").find("1 MiB"), std::string::npos);
}

TEST_F(settings_file_test, a_file_that_cannot_be_written_is_told) {
  std::filesystem::create_directory(file);
  for (const std::filesystem::path& place : {file, directory / "none" / "settings.json"}) {
    try {
      write_settings(place, full());
      ADD_FAILURE() << place;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::render_failed);
      EXPECT_EQ(std::string(error.what()).find(place.string() + ": "), 0u) << error.what();
    }
  }
}
