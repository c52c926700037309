// tests/data/bad: each scene there breaks one rule, which its name says; its first line is a comment with the whole message
// that is expected.
#include <algorithm>
#include <vector>

#include "scene_text.h"

namespace oclair {

namespace {

const std::filesystem::path DIRECTORY = std::filesystem::path(OCLAIR_TEST_DIRECTORY) / "data" / "bad";

std::vector<std::string> bad_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(DIRECTORY))
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class bad_scene_test : public testing::TestWithParam<std::string> {};

TEST_P(bad_scene_test, is_refused_with_the_line_of_its_first_comment) {
  const auto file = DIRECTORY / (GetParam() + ".xml");
  std::string expected;
  std::getline(std::ifstream(file), expected);
  ASSERT_GT(expected.size(), 9u);
  expected = expected.substr(5, expected.size() - 9);
  try {
    read_scene(file);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(message_without(DIRECTORY, error.what()), expected);
    EXPECT_EQ(error.exit, Exit::scene);
  }
}

INSTANTIATE_TEST_SUITE_P(, bad_scene_test, testing::ValuesIn(bad_scenes()), [](const auto& scene) { return scene.param; });

}  // namespace

}  // namespace oclair
