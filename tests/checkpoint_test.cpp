// The file of a checkpoint: what was written comes back, and nothing else is taken for it.
#include "../host/checkpoint.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <functional>

#include "../host/error.h"
#include "../host/xxh3.h"
#include "checkpoint_cases.h"
#include "faults.h"
#include "files.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;

// The message of the refusal, which has one line; empty if the file was read.
std::string refusal(const fs::path& path) {
  try {
    read_checkpoint(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    EXPECT_NE(message.find("expected "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  return "";
}

const Checkpoint small = random_checkpoint({{0, 48}, {64, 40}}, 1);

// The file of `small`, in parts.
struct Parts {
  std::string format, head, arrays;
};

Parts parts_of(const std::string& bytes) {
  const std::size_t head = bytes.find('{'), arrays = bytes.find("}\n") + 2;
  return {bytes.substr(0, bytes.find('\n') + 1), bytes.substr(head, arrays - head), bytes.substr(arrays)};
}

// A file whose checksum of the head is right whatever the head says.
std::string forged(const Parts& parts) {
  const std::string size = std::to_string(parts.head.size());
  return parts.format + std::string(8 - size.size(), '0') + size + " " + xxh3_digits(parts.head.data(), parts.head.size()) +
         "\n" + parts.head + parts.arrays;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class checkpoint_test : public testing::Test {
 protected:
  checkpoint_test() {
    write_checkpoint(path, small);
    bytes = content(path);
  }

  const TemporaryDirectory directory;
  const fs::path path = directory / "a.checkpoint";
  std::string bytes;
};

TEST_F(checkpoint_test, what_is_written_comes_back) {
  expect_same(read_checkpoint(path), small);
  Checkpoint plain = random_checkpoint({{MAX_SAMPLES - 16, 16}}, 2, false);
  plain.layers.clear();
  plain.identity = {
      {"", ""}, {"\xc3\xa4", "line\n\"quoted\"\\\x01"}, {"not UTF-8", "\xff\xfe\x80"}, {"zero", std::string(1, '\0')}};
  plain.head.moment_name = "\xe4";
  plain.head.attributes = {};
  write_checkpoint(path, plain);
  expect_same(read_checkpoint(path), plain);
}

TEST_F(checkpoint_test, a_film_of_one_pixel_comes_back) {
  Checkpoint one = random_checkpoint({{0, 1}}, 3);
  one.film = random_film(1, 1, one.ranges, true, 3);
  one.head.film.crop_width = one.head.film.crop_height = 1;
  one.layers.clear();
  write_checkpoint(path, one);
  expect_same(read_checkpoint(path), one);
}

TEST_F(checkpoint_test, two_equal_checkpoints_have_equal_bytes) {
  write_checkpoint(path, small);
  EXPECT_TRUE(content(path) == bytes);
}

TEST_F(checkpoint_test, its_head_alone_says_all_but_the_arrays) {
  const Checkpoint head = read_checkpoint_head(path);
  EXPECT_EQ(head.identity, small.identity);
  EXPECT_EQ(head.ranges, small.ranges);
  EXPECT_EQ(head.film.width, 3u);
  EXPECT_EQ(head.film.height, 2u);
  EXPECT_EQ(head.film.exponent, -3);
  EXPECT_EQ(head.film.samples, 88u);
  expect_same_head(head.head, small.head);
  EXPECT_TRUE(head.film.pixels.empty() && head.film.moments.empty() && head.film.errors.empty());
}

TEST_F(checkpoint_test, any_changed_byte_is_refused) {
  Random random(3);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int change : {1, static_cast<int>(1 + random.below(255))}) {
      std::string changed = bytes;
      changed[i] = static_cast<char>(changed[i] ^ change);
      put(path, changed);
      EXPECT_NE(refusal(path), "") << "byte " << i << " changed by " << change;
    }
}

TEST_F(checkpoint_test, a_file_that_ends_too_soon_or_too_late_is_refused) {
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    put(path, bytes.substr(0, length));
    EXPECT_NE(refusal(path), "") << length << " bytes";
  }
  for (const std::size_t more : {1, 16, 4096}) {
    put(path, bytes + std::string(more, '\0'));
    EXPECT_NE(refusal(path).find("has " + std::to_string(more) + " bytes after its last array"), std::string::npos);
  }
}

TEST_F(checkpoint_test, the_message_says_which_part_is_damaged) {
  const Parts parts = parts_of(bytes);
  const std::size_t head = bytes.find('{'), pixels = bytes.size() - parts.arrays.size();
  const std::size_t moments = pixels + 6 * sizeof(FilmPixel), errors = moments + 6 * sizeof(FilmMoments),
                    layer = errors + 6 * sizeof(FilmErrors);
  const std::pair<std::size_t, const char*> places[] = {{0, "is not a checkpoint"},
                                                        {18, "is a checkpoint of another version"},
                                                        {head, "its head is damaged"},
                                                        {pixels, "its array pixels is damaged"},
                                                        {moments, "its array moments is damaged"},
                                                        {errors, "its array errors is damaged"},
                                                        {layer, "its array albedo.R is damaged"}};
  for (const auto& [at, part] : places) {
    std::string changed = bytes;
    changed[at] ^= 1;
    put(path, changed);
    EXPECT_NE(refusal(path).find(part), std::string::npos) << refusal(path);
    put(path, bytes.substr(0, at));
    EXPECT_NE(refusal(path).find("cut short"), std::string::npos) << refusal(path);
  }
}

TEST_F(checkpoint_test, what_is_no_file_is_refused) {
  EXPECT_NE(refusal(directory / "none").find("cannot be read: No such file or directory"), std::string::npos);
  EXPECT_NE(refusal(directory / "").find("is not a regular file"), std::string::npos);
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);
  EXPECT_NE(refusal(directory / "pipe").find("is not a regular file"), std::string::npos);
}

// The head is whole, with a checksum that is right: made by a hand or a program that is not ours. Nothing is allocated that the
// file does not hold: 2^32 pixels would take 256 GiB.
TEST_F(checkpoint_test, a_head_that_says_nonsense_is_refused) {
  const std::pair<const char*, const char*> replacements[] = {
      {"\"crop\":[2,4,3,2]", "\"crop\":[0,0,65536,65536]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,4294967295,2]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,3,0]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,2,2]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,3]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,3,-2]"},
      {"\"crop\":[2,4,3,2]", "\"crop\":[2,4,3.0,2]"},
      {"\"size\":[5,7]", "\"size\":[65536,65537]"},
      {"\"size\":[5,7]", "\"size\":7"},
      {"\"exponent\":-3", "\"exponent\":-2147483648"},
      {"\"exponent\":-3", "\"exponent\":18446744073709551615"},
      {"\"exponent\":-3", "\"exponent\":1e999"},
      {"\"exponent\":-3", "\"exponents\":-3"},
      {"\"rays\":123456789012", "\"rays\":-1"},
      {"\"kept\":1", "\"kept\":2"},
      {"[[0,48],[64,40]]", "[]"},
      {"[[0,48],[64,40]]", "[[0,48],[48,40]]"},
      {"[[0,48],[64,40]]", "[[64,48],[0,40]]"},
      {"[[0,48],[64,40]]", "[[0,48],[65,39]]"},
      {"[[0,48],[64,40]]", "[[8,40],[64,40]]"},
      {"[[0,48],[64,40]]", "[[0,48],[64,0]]"},
      {"[[0,48],[64,40]]", "[[0,48],[64,8589934592]]"},
      {"[[0,48],[64,40]]", "[[0,48],[18446744073709551600,16]]"},
      {"[[0,48],[64,40]]", "[[0,48],[64,[40]]]"},
      {"[[0,48],[64,40]]", "[[0,16]]"},  // the pixels count more
      {"[\"pixels\",384", "[\"pixels\",385"},
      {"[\"pixels\",384", "[\"pixels\",0"},
      {"[\"pixels\",384", "[\"pixels\",9223372036854775807"},
      {"[\"pixels\",384", "[\"pixels\",18446744073709551615"},
      {"[\"moments\",864", "[\"moments\",0"},
      {"[\"moments\",864", "[\"other\",864"},
      {"[\"errors\",720", "[\"errors\",0"},
      {"\"filter\":1", "\"filter\":3"},
      {"\"pixel format\":5", "\"pixel format\":6"},
      {"\"filter radius\":1.25", "\"filter radius\":-1.25"},
      {"\"filter radius\":1.25", "\"filter radius\":null"},
      {"\"layers\":[\"albedo.R\"]", "\"layers\":[\"albedo.R\",\"albedo.G\"]"},
      {"\"layers\":[\"albedo.R\"]", "\"layers\":[]"},
      {"\"moment name\":\"m\"", "\"moment name\":[1,256]"},
      {"\"moment name\":\"m\"", "\"moment name\":[[[[[[[[1]]]]]]]]"},
      {"{", "[{"},
      {"{", ""},
  };
  const Parts parts = parts_of(bytes);
  put(path, forged(parts));
  EXPECT_EQ(refusal(path), "");
  for (const auto& [from, to] : replacements) {
    Parts wrong = parts;
    wrong.head = replaced(parts.head, from, to);
    put(path, forged(wrong));
    EXPECT_NE(refusal(path), "") << to;
  }
  Parts deep = parts;
  deep.head = std::string(1000000, '[');
  put(path, forged(deep));
  EXPECT_NE(refusal(path).find("is nested too deeply"), std::string::npos);
}

// Bytes of the head and pieces of it, changed, repeated and left out, under a right checksum: read or refused, never worse.
TEST_F(checkpoint_test, a_head_changed_at_random_is_read_or_refused) {
  Random random(4);
  const Parts parts = parts_of(bytes);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    Parts wrong = parts;
    for (std::uint32_t changes = 1 + random.below(4); changes > 0; --changes) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(wrong.head.size()));
      const std::string piece =
          parts.head.substr(random.below(static_cast<std::uint32_t>(parts.head.size())), random.below(20));
      switch (random.below(4)) {
        case 0: wrong.head[at] = static_cast<char>(random.below(256)); break;
        case 1: wrong.head[at] = "0123456789-.[]{},\""[random.below(18)]; break;
        case 2: wrong.head.insert(at, piece); break;
        default: wrong.head.erase(at, random.below(8)); break;
      }
    }
    put(path, forged(wrong));
    refused += !refusal(path).empty();
  }
  EXPECT_GT(refused, 750);   // most places matter
  EXPECT_LT(refused, 1500);  // a name of an entry does not
}

// What the attempt to write another checkpoint to the path is refused with.
std::string failure_to_write(const fs::path& path) {
  try {
    write_checkpoint(path, random_checkpoint({{0, 16}}, 9));
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    return error.what();
  }
  return "";
}

TEST_F(checkpoint_test, a_disk_without_room_keeps_the_previous_checkpoint) {
  for (const std::size_t room : {std::size_t{0}, std::size_t{1}, std::size_t{100}, bytes.size() / 2, bytes.size() - 100}) {
    std::string message;
    {
      const FileSizeLimit full(room);
      message = failure_to_write(path);
    }
    EXPECT_NE(message.find("a.checkpoint: cannot be written: "), std::string::npos) << message;
    EXPECT_NE(message.find("expected room"), std::string::npos) << message;
    EXPECT_TRUE(content(path) == bytes);
    EXPECT_EQ(directory.names(), std::vector<std::string>{"a.checkpoint"});
  }
}

TEST_F(checkpoint_test, a_directory_that_may_not_be_written_keeps_the_previous_checkpoint) {
  const fs::path inner = directory / "inner/a.checkpoint";
  fs::create_directory(inner.parent_path());
  write_checkpoint(inner, small);
  {
    const ReadOnlyDirectory locked(inner.parent_path());
    EXPECT_NE(failure_to_write(inner).find("a.checkpoint: cannot be created: Permission denied"), std::string::npos);
  }
  expect_same(read_checkpoint(inner), small);
}

TEST_F(checkpoint_test, a_checkpoint_replaced_by_a_directory_is_refused_and_untouched) {
  fs::remove(path);
  fs::create_directory(path);
  put(path / "inside", "kept");
  EXPECT_NE(failure_to_write(path).find("a.checkpoint: is a directory, expected "), std::string::npos);
  EXPECT_NE(refusal(path).find("is not a regular file"), std::string::npos);
  EXPECT_EQ(content(path / "inside"), "kept");
}

}  // namespace
