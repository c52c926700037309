// Scenes written down in a test: files in a directory of their own that goes away with it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "../host/error.h"
#include "../host/reader.h"

namespace oclair {

class SceneDirectory {
 public:
  SceneDirectory() {
    std::string name = (std::filesystem::path(testing::TempDir()) / "oclair_scene_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no directory for the test");
    path_ = name;
  }
  ~SceneDirectory() { std::filesystem::remove_all(path_); }
  SceneDirectory(const SceneDirectory&) = delete;
  SceneDirectory& operator=(const SceneDirectory&) = delete;

  std::filesystem::path path() const { return path_; }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
  }

  // What stands inside <scene>, read as scene.xml in this directory.
  World read(const std::string& content, const Definitions& definitions = {}) const {
    write("scene.xml", "<scene version=\"3.0.0\">\n" + content + "\n</scene>\n");
    return read_scene(path_ / "scene.xml", definitions);
  }

 private:
  std::filesystem::path path_;
};

inline const std::string SENSOR = "<sensor type=\"perspective\"/>";

// The content of a scene that needs no other file; a sensor is added.
inline World world_of(const std::string& content, const Definitions& definitions = {}) {
  return SceneDirectory().read(content + SENSOR, definitions);
}

// The message with the directory taken out of its paths; empty if nothing was thrown.
inline std::string message_without(const std::filesystem::path& directory, const std::string& message) {
  std::string result = message;
  const std::string prefix = directory.string() + "/";
  for (auto at = result.find(prefix); at != std::string::npos; at = result.find(prefix)) result.erase(at, prefix.size());
  return result;
}

inline void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

}  // namespace oclair
