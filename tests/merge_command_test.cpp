// `oclair merge`: from the checkpoints of parts to one file.
#include <array>
#include <cmath>

#include "../host/checkpoint_lock.h"
#include "checkpoint_cases.h"
#include "exr_reader.h"
#include "faults.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class merge_command_test : public testing::Test {
 protected:
  merge_command_test() {
    write_checkpoint(a, first);
    write_checkpoint(b, second);
  }

  ProgramResult merge_them(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"merge", a, b};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_oclair(arguments);
  }

  void expect_refused(const ProgramResult& result, const std::vector<std::string>& parts) const {
    EXPECT_EQ(result.exit, 1);
    EXPECT_EQ(result.out, "");
    for (const std::string& part : parts) EXPECT_TRUE(contains(result.err, part)) << part << " is missing in:\n" << result.err;
    EXPECT_FALSE(fs::exists(image));
  }

  const TemporaryDirectory directory;
  const std::string a = directory / "a.checkpoint", b = directory / "b.checkpoint";
  const fs::path image = directory / "image.exr", joined_file = directory / "joined.checkpoint";
  const Checkpoint first = random_checkpoint({{0, 32}}, 1), second = random_checkpoint({{32, 20}}, 2);
};

TEST_F(merge_command_test, the_checkpoint_of_the_parts_is_that_of_all_samples) {
  const ProgramResult result = merge_them({"--checkpoint", joined_file.string()});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.out, joined_file.string() + "\n");
  expect_same(read_checkpoint(joined_file), merge({first, second}));
  EXPECT_EQ(directory.names().size(), 3u);
}

TEST_F(merge_command_test, the_image_of_the_parts_is_that_of_their_joined_checkpoint) {
  EXPECT_EQ(merge_them({"-o", image.string(), "--checkpoint", joined_file.string()}).exit, 0);
  const std::string expected = content(image);
  const ExrFile exr = read_exr(image);
  EXPECT_EQ(std::get<std::string>(exr.attributes.at("samplesPerPixel")), "52");
  EXPECT_EQ(std::get<std::string>(exr.attributes.at("software")), "oclair");  // from the checkpoint
  EXPECT_EQ(exr.window.crop_x, 2u);
  EXPECT_EQ(exr.window.film_height, 7u);
  fs::remove(image);
  EXPECT_EQ(run_oclair({"merge", joined_file.string(), "-o", image.string()}).exit, 0);
  EXPECT_TRUE(content(image) == expected);
  EXPECT_EQ(run_oclair({"merge", b, a, "-o", image.string()}).exit, 0);
  EXPECT_TRUE(content(image) == expected);
  const fs::path png = directory / "image.png";
  EXPECT_EQ(merge_them({"-o", png.string()}).out, png.string() + "\n");
  EXPECT_TRUE(fs::exists(png));
}

// Of three parts the one that gives a layer is the first that has it, in whatever order they are named.
TEST_F(merge_command_test, layers_that_the_first_part_lacks_are_those_of_the_next_one_that_has_them) {
  Checkpoint none = first, early = second, late = random_checkpoint({{64, 16}}, 3);
  none.layers.clear();
  early.layers[0].values[0] = 7.0f;
  late.layers[0].values[0] = 8.0f;
  const std::string c = directory / "c.checkpoint";
  write_checkpoint(a, none);
  write_checkpoint(b, early);
  write_checkpoint(c, late);
  for (const auto& [x, y, z] : {std::array{a, b, c}, {c, a, b}, {a, c, b}, {c, b, a}}) {
    fs::remove(joined_file);
    ASSERT_EQ(run_oclair({"merge", x, y, z, "--checkpoint", joined_file.string()}).exit, 0);
    expect_same_layers(read_checkpoint(joined_file).layers, early.layers);
  }
}

TEST_F(merge_command_test, samples_that_the_standard_error_lacks_are_counted_in_a_warning) {
  const std::string c = directory / "c.checkpoint";
  write_checkpoint(c, random_checkpoint({{64, 15}}, 3));
  const ProgramResult result = run_oclair({"merge", c, a, b, "-o", image.string()});
  EXPECT_EQ(result.exit, 0);
  EXPECT_TRUE(contains(result.err,
                       "19 of the 67 samples per pixel count in the image and not in its standard error, since a range "
                       "(0:52 64:15) holds no multiple of 16\n"))
      << result.err;
  write_checkpoint(b, random_checkpoint({{32, 48}}, 2));
  const ProgramResult whole = merge_them({"-o", image.string()});
  EXPECT_EQ(whole.exit, 0);
  EXPECT_FALSE(contains(whole.err, "standard error")) << whole.err;
}

TEST_F(merge_command_test, a_part_may_become_the_whole) {
  EXPECT_EQ(merge_them({"--checkpoint", a}).exit, 0);
  expect_same(read_checkpoint(a), merge({first, second}));
  EXPECT_EQ(directory.names().size(), 2u);
}

// A checkpoint is one whatever its name, and an image does not hold its sums.
TEST_F(merge_command_test, no_part_becomes_the_image) {
  const std::string part = directory / "part.exr", link = directory / "link.exr";
  fs::copy_file(b, part);
  fs::create_symlink(part, link);
  for (const std::string& output : {part, link}) {
    const ProgramResult result = run_oclair({"merge", a, part, "-o", output});
    EXPECT_EQ(result.exit, 2) << result.err;
    EXPECT_TRUE(contains(result.err, output + ": is another output or an input of this command as well")) << result.err;
    EXPECT_TRUE(content(part) == content(b));
  }
}

TEST_F(merge_command_test, the_same_samples_twice_are_refused_with_both_files_and_ranges) {
  write_checkpoint(b, random_checkpoint({{16, 48}}, 2));
  expect_refused(merge_them({"-o", image.string()}), {a, b, "0:32", "16:48", "overlap"});
  expect_refused(run_oclair({"merge", a, a, "-o", image.string()}), {"0:32", "overlap"});
}

TEST_F(merge_command_test, another_render_is_refused_with_all_that_differs) {
  Checkpoint other = second;
  other.identity = {{"scene", "fedcba9876543210"}, {"seed", "8"}};
  write_checkpoint(b, other);
  expect_refused(
      merge_them({"-o", image.string()}),
      {b + ": is of another render", "scene is fedcba9876543210, expected 0123456789abcdef", "seed is 8, expected 7"});
}

TEST_F(merge_command_test, a_damaged_part_is_refused_and_what_was_there_is_kept) {
  const std::string whole = content(b);
  std::string changed = whole;
  changed[changed.size() - 10] ^= 1;
  put(b, changed);
  expect_refused(merge_them({"-o", image.string()}), {b + ": its array albedo.R is damaged"});
  const std::string old = content(a);
  put(b, whole.substr(0, whole.size() / 2));
  expect_refused(merge_them({"--checkpoint", a}), {b + ": was cut short"});
  EXPECT_TRUE(content(a) == old);
  expect_refused(run_oclair({"merge", a, directory / "none", "-o", image.string()}), {"none: cannot be read: No such file"});
}

TEST_F(merge_command_test, of_several_files_that_cannot_be_written_each_is_named_on_one_line) {
  const FileSizeLimit full(1000);  // what the program says lies in a file too
  const ProgramResult result = merge_them({"-o", image.string(), "--checkpoint", joined_file.string()});
  expect_refused(result, {image.string() + ": cannot be written: ", "; " + joined_file.string() + ": cannot be written: "});
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), ';'), 1) << result.err;
  EXPECT_FALSE(fs::exists(joined_file));
}

TEST_F(merge_command_test, a_checkpoint_that_a_render_writes_is_left_to_it) {
  const CheckpointLock lock(joined_file);
  expect_refused(merge_them({"--checkpoint", joined_file.string()}), {"joined.checkpoint: is being written by process"});
  EXPECT_FALSE(fs::exists(joined_file));
}

TEST_F(merge_command_test, a_target_that_is_a_directory_is_refused) {
  fs::create_directory(joined_file);
  expect_refused(merge_them({"--checkpoint", joined_file.string()}), {"joined.checkpoint: is a directory"});
}

}  // namespace
