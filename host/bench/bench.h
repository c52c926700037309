// The parts of `oclair bench`. Each adds its rows to the table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "../reader.h"
#include "table.h"

namespace oclair::bench {

struct Options {
  std::optional<std::filesystem::path> scene;  // otherwise: generated meshes
  Definitions definitions;
  std::optional<std::uint64_t> triangles;  // of the generated mesh; otherwise: those that the targets are about
  unsigned rounds = 7;
  std::string device;
};

void bench_traversal(const Options& options, Table& table);
void bench_growth(const Options& options, Table& table);  // the cost of a ray over the number of triangles
void bench_path(const Options& options, Table& table);
void bench_build(const Options& options, Table& table);
void bench_start(const Options& options, Table& table);
void bench_sampler(const Options& options, Table& table);

}  // namespace oclair::bench
