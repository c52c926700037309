// `oclair info` of a checkpoint.
#include <algorithm>
#include <sstream>

#include "../host/film.h"
#include "checkpoint_cases.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;

class info_checkpoint_test : public testing::Test {
 protected:
  ProgramResult info() const { return run_oclair({"info", file}); }

  static void expect_lines(const ProgramResult& result, const std::vector<std::string>& lines) {
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.err, "");
    for (const std::string& line : lines)
      EXPECT_NE(result.out.find(line + "\n"), std::string::npos) << line << " is missing in\n" << result.out;
  }

  // One line that names the file and ends thus; nothing on standard output.
  void expect_refused(const std::string& end) const {
    const ProgramResult result = info();
    EXPECT_EQ(result.exit, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(file + ": "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(end), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  const TemporaryDirectory directory;
  const std::string file = directory / "a.checkpoint";
};

TEST_F(info_checkpoint_test, prints_all_that_the_checkpoint_says_of_itself) {
  Checkpoint checkpoint = random_checkpoint({{0, 32}, {48, 20}}, 1);
  checkpoint.identity.emplace_back("program", "9.8.7");
  checkpoint.head.attributes.emplace_back("device", "an\nabacus");
  checkpoint.layers.push_back({"primitive.id", std::vector<float>(6)});
  write_checkpoint(file, checkpoint);
  expect_lines(
      info(),
      {"checkpoint          " + file, "scene               0123456789abcdef", "seed                7",
       "program             9.8.7", "film                3x2 at 2,4 of 5x7, exponent -3, with second moments",
       "samples             0:32", "samples             48:20", "samples per pixel   52, 3 complete replicas",
       "rejected samples    " + std::to_string(rejected_samples(checkpoint.film)), "rays                123456789012",
       "layer               albedo.R", "layer               primitive.id", "header              software: oclair",
       "header              device: an?abacus", "kept                yes: stays when its render is done"});
}

TEST_F(info_checkpoint_test, a_film_that_is_read_in_pieces_has_the_figures_of_the_whole) {
  Checkpoint checkpoint = random_checkpoint({{0, 64}}, 1);
  checkpoint.film = random_film(211, 209, checkpoint.ranges, true, 2);
  checkpoint.head.film = {211, 209, 0, 0, 211, 209};
  checkpoint.layers.clear();
  for (FilmPixel& pixel : checkpoint.film.pixels) pixel.rejected %= 64, pixel.hits = 64 - pixel.rejected;
  ASSERT_GT(checkpoint.film.pixels.size(), FILM_PIECE);
  ASSERT_TRUE(image_error(checkpoint.film));
  write_checkpoint(file, checkpoint);
  std::ostringstream error;
  error << *image_error(checkpoint.film);
  expect_lines(info(), {"film                211x209, exponent -3, with second moments",
                        "rejected samples    " + std::to_string(rejected_samples(checkpoint.film)), "estimated error     " + error.str()});
  ++checkpoint.film.pixels.back().hits;
  write_checkpoint(file, checkpoint);
  expect_refused("a pixel counts more samples than there are, expected at most 64");
}

TEST_F(info_checkpoint_test, a_checkpoint_is_one_by_what_it_holds_whatever_its_name) {
  Checkpoint checkpoint = random_checkpoint({{0, 16}}, 1, false);
  checkpoint.kept = false;
  checkpoint.head.film = {3, 2, 0, 0, 3, 2};
  const std::string other = directory / "scene.xml";
  write_checkpoint(other, checkpoint);
  expect_lines(run_oclair({"info", other}),
               {"film                3x2, exponent -3", "kept                no: goes when its render is done"});
}

TEST_F(info_checkpoint_test, a_broken_one_is_refused_with_what_is_broken) {
  write_checkpoint(file, random_checkpoint({{0, 16}}, 1));
  const std::string whole = content(file);
  put(file, whole.substr(0, whole.size() - 1));
  expect_refused("was cut short within its array albedo.R, expected all arrays that its head lists");
  put(file, whole.substr(0, 10));
  expect_refused("is not a checkpoint, or was cut short within its first lines");
  put(file, "");
  expect_refused("is not a checkpoint, or was cut short within its first lines");
  std::string changed = whole;
  changed.back() ^= 1;
  put(file, changed);
  expect_refused("its array albedo.R is damaged");
  fs::remove(file);
  expect_refused("cannot be read: ");
  fs::create_directory(file);
  expect_refused("is not a regular file");
}

}  // namespace
