// What is measured: generated scenes, or the one that was asked for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "../scene.h"
#include "bench.h"

namespace oclair::bench {

struct Subject {
  std::string name;
  std::function<Scene()> make;  // reads or generates it
};

std::string short_count(std::size_t count);  // "70k", "1.3M"

// Bare triangles: the scene's, or a generated mesh of the asked size, or those that the targets are about and more.
std::vector<Subject> traversal_subjects(const Options& options, Table& table);

// Whole scenes, films of at most 512x512: the one that was asked for, or a generated mesh of the asked size, or the two that
// the targets are about and, where the source tree is at hand, some of its scenes.
std::vector<Subject> path_subjects(const Options& options);

// Whole scenes: the one that was asked for, or generated meshes.
std::vector<Subject> build_subjects(const Options& options);

// scenes/NAME.xml of the source tree, where that is at hand.
std::optional<std::filesystem::path> own_scene(const std::string& name);

}  // namespace oclair::bench
