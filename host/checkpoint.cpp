#include "checkpoint.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <memory>
#include <optional>

#include "checkpoint_head.h"
#include "error.h"
#include "file_aside.h"
#include "film.h"
#include "xxh3.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

// The arrays are the bytes in memory. Whoever changes one of these raises FORMAT.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(FilmPixel) == 64 && sizeof(FilmMoments) == 144 && sizeof(FilmErrors) == 120);

// The file: this line; a line of the head's size and checksum; the head; the arrays.
const std::string FORMAT = "oclair checkpoint 1\n";
constexpr std::size_t SIZE_DIGITS = 8, CHECKSUM_DIGITS = 32;
const std::size_t PROLOGUE = FORMAT.size() + SIZE_DIGITS + 1 + CHECKSUM_DIGITS + 1;

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& expected) {
  throw Error(Exit::render_failed, path.string() + ": " + one_line(what) + ", expected " + one_line(expected));
}

std::string prologue(const std::string& head) {
  const std::string digits = std::to_string(head.size());
  return FORMAT + std::string(SIZE_DIGITS - digits.size(), '0') + digits + " " + xxh3_digits(head.data(), head.size()) + "\n";
}

// A file that is read from its start to its end. It stays the same one when another takes its name meanwhile.
class Input {
 public:
  explicit Input(const fs::path& path) : path_(path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe would wait for its writer
    struct stat status {};
    if (descriptor < 0) fail_to_read(errno);
    file_.reset(fdopen(descriptor, "rb"));
    if (!file_ || fstat(descriptor, &status) != 0) fail_to_read(errno);
    if (!S_ISREG(status.st_mode)) fail(path, "is not a regular file", "a checkpoint");
    rest_ = size_ = static_cast<std::uint64_t>(status.st_size);
  }

  // Back, or forth, to where so many bytes follow.
  void go_to(std::uint64_t rest) {
    if (fseeko(file_.get(), static_cast<off_t>(size_ - rest), SEEK_SET) != 0) fail_to_read(errno);
    rest_ = rest;
  }

  std::uint64_t rest() const { return rest_; }  // bytes that follow

  void read(void* bytes, std::size_t count) {
    rest_ -= count;
    if (count == 0 || std::fread(bytes, 1, count, file_.get()) == count) return;
    if (std::ferror(file_.get())) fail_to_read(errno);
    fail(path_, "has become shorter while it was read", "a whole checkpoint");
  }

  std::string text(std::size_t count) {
    std::string result(count, '\0');
    read(result.data(), count);
    return result;
  }

 private:
  [[noreturn]] void fail_to_read(int error) const {
    fail(path_, "cannot be read: " + system_message(error), "a checkpoint");
  }
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  fs::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0, rest_ = 0;
};

std::optional<std::size_t> decimal(const std::string& digits) {
  std::size_t number = 0;
  for (const char digit : digits) {
    if (digit < '0' || digit > '9') return std::nullopt;
    number = 10 * number + static_cast<std::size_t>(digit - '0');
  }
  return number;
}

CheckpointHead read_head(const fs::path& path, Input& input) {
  if (input.rest() < PROLOGUE) fail(path, "is not a checkpoint, or was cut short within its first lines", "a whole checkpoint");
  const std::string lines = input.text(PROLOGUE);
  if (!lines.starts_with(FORMAT)) {
    const bool ours = lines.starts_with(FORMAT.substr(0, FORMAT.rfind(' ') + 1));
    fail(path, ours ? "is a checkpoint of another version of the format" : "is not a checkpoint",
         "its first line to be \"" + FORMAT.substr(0, FORMAT.size() - 1) + "\"");
  }
  const std::optional<std::size_t> size = decimal(lines.substr(FORMAT.size(), SIZE_DIGITS));
  if (!size || *size > MAX_HEAD) fail(path, "says a wrong size of its head", "at most " + std::to_string(MAX_HEAD) + " bytes");
  if (*size > input.rest()) fail(path, "was cut short within its head", "a whole checkpoint");
  const std::string text = input.text(*size);
  if (prologue(text) != lines) fail(path, "its head is damaged", "the checksum that was written with it");
  try {
    return parse_head(text);
  } catch (const CheckpointHeadError& error) {
    fail(path, std::string("its head ") + error.what(), "a head that oclair has written");
  }
}

// What follows the head is as long as the head says, and each array as long as the film requires.
void check_arrays(const fs::path& path, const CheckpointHead& head, std::uint64_t rest) {
  std::uint64_t sum = 0;
  for (const ArrayEntry& array : head.arrays) {
    if (array.bytes > rest - sum)
      fail(path, "was cut short within its array " + array.name, "all arrays that its head lists");
    sum += array.bytes;
  }
  if (sum != rest) fail(path, "has " + std::to_string(rest - sum) + " bytes after its last array", "the end of the file");
  const std::uint64_t pixels = std::uint64_t{head.checkpoint.film.width} * head.checkpoint.film.height;
  std::size_t next = 0;
  const auto check = [&](const std::string& name, std::size_t element, bool may_be_absent) {
    if (next == head.arrays.size() || head.arrays[next].name != name) fail(path, "its head lacks the array " + name, name);
    const std::uint64_t bytes = head.arrays[next++].bytes;
    if (bytes != pixels * element && !(bytes == 0 && may_be_absent))
      fail(path, "its array " + name + " has " + std::to_string(bytes) + " bytes", std::to_string(pixels * element));
  };
  for_each_array([&](const char* name, bool may_be_absent, const auto& array) { check(name, sizeof array[0], may_be_absent); },
                 head.checkpoint.film);
  for (const Layer& layer : head.checkpoint.layers) check(layer.name, sizeof layer.values[0], false);
  if (next != head.arrays.size()) fail(path, "its head lists the unknown array " + head.arrays[next].name, "no other array");
}

// Calls use(bytes, count) for an array's bytes, some MiB at a time.
template <typename Array, typename Use>
void for_each_bytes(Array& array, Use use) {
  for_each_piece(array.size(), [&](std::size_t first, std::size_t end) { use(array.data() + first, (end - first) * sizeof array[0]); },
                 array);
}

[[noreturn]] void fail_of_checksum(const fs::path& path, const ArrayEntry& entry) {
  fail(path, "its array " + entry.name + " is damaged", "the checksum that its head says");
}

// No pixel counts more samples than there are.
void check_counts(const fs::path& path, const Film& film, std::size_t pixel) {
  const FilmPixel& counts = film.pixels[pixel];
  if (counts.rejected > film.samples || counts.hits > film.samples - counts.rejected)
    fail(path, "a pixel counts more samples than there are", "at most " + std::to_string(film.samples));
}

template <typename Array>
void read_array(const fs::path& path, Input& input, const ArrayEntry& entry, Array& values) {
  values.resize(entry.bytes / sizeof values[0]);
  Xxh3 checksum;
  for_each_bytes(values, [&](void* bytes, std::size_t count) {
    input.read(bytes, count);
    checksum.add(bytes, count);
  });
  if (checksum.digits() != entry.checksum)
    fail_of_checksum(path, entry);
}

void read_arrays(const fs::path& path, Input& input, const std::vector<ArrayEntry>& entries, Checkpoint& checkpoint) {
  std::size_t next = 0;
  for_each_array([&](const char*, bool, auto& values) { read_array(path, input, entries[next++], values); }, checkpoint.film);
  for (Layer& layer : checkpoint.layers) read_array(path, input, entries[next++], layer.values);
  const Film& film = checkpoint.film;
  for_each_element(film.pixels.size(), [&](std::size_t i) { check_counts(path, film, i); }, film.pixels);
}

// Reads what read_arrays does, and keeps nothing.
void check_checksums(const fs::path& path, Input& input, const std::vector<ArrayEntry>& entries) {
  std::vector<char> piece(std::size_t{1} << 20);
  for (const ArrayEntry& entry : entries) {
    Xxh3 checksum;
    for (std::uint64_t rest = entry.bytes; rest > 0;) {
      const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(rest, piece.size()));
      input.read(piece.data(), count);
      checksum.add(piece.data(), count);
      rest -= count;
    }
    if (checksum.digits() != entry.checksum) fail_of_checksum(path, entry);
  }
}

// Calls look(film, pixel) for each pixel, with pixels and errors of films that are pieces of the file's, whose arrays begin where `rest`
// bytes follow.
template <typename Look>
void look_at_pixels(Input& input, std::uint64_t rest, const CheckpointHead& head, Look look) {
  Film piece = head.checkpoint.film;
  const auto read = [&](auto& array, const std::string& name, std::size_t first, std::size_t end) {
    array.resize(end - first);
    std::uint64_t before = first * sizeof array[0];
    for (const ArrayEntry& entry : head.arrays) {
      if (entry.name == name) break;
      before += entry.bytes;
    }
    input.go_to(rest - before);
    input.read(array.data(), array.size() * sizeof array[0]);
  };
  for_each_piece(std::size_t{piece.width} * piece.height, [&](std::size_t first, std::size_t end) {
    read(piece.pixels, "pixels", first, end);
    read(piece.errors, "errors", first, end);
    for (std::size_t i = 0; i < end - first; ++i) look(piece, i);
  });
}

[[maybe_unused]] bool is_sound(const Checkpoint& checkpoint) {
  const Film& film = checkpoint.film;
  const std::size_t pixels = std::size_t{film.width} * film.height;
  return film.samples == count_samples(checkpoint.ranges) && film.replicas == count_replicas(checkpoint.ranges) &&
         film.width == checkpoint.head.film.crop_width && film.height == checkpoint.head.film.crop_height &&
         film.pixels.size() == pixels && film.errors.size() == pixels &&
         (film.moments.empty() || film.moments.size() == pixels) &&
         std::all_of(checkpoint.layers.begin(), checkpoint.layers.end(),
                     [&](const Layer& layer) { return layer.values.size() == pixels; });
}

}  // namespace

bool begins_like_checkpoint(const fs::path& path) {
  const std::string ours = FORMAT.substr(0, FORMAT.rfind(' ') + 1);
  std::string first(ours.size(), '\0');
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;  // a pipe would wait for its writer
  std::ifstream file(path, std::ios::binary);
  return file.read(first.data(), static_cast<std::streamsize>(first.size())) && first == ours;
}

void write_checkpoint(const fs::path& path, const Checkpoint& checkpoint) {
  assert(is_sound(checkpoint));
  std::vector<ArrayEntry> entries;
  const auto enter = [&](const std::string& name, const auto& values) {
    Xxh3 checksum;
    for_each_bytes(values, [&](const void* bytes, std::size_t count) { checksum.add(bytes, count); });
    entries.push_back({name, values.size() * sizeof values[0], checksum.digits()});
  };
  for_each_array([&](const char* name, bool, const auto& values) { enter(name, values); }, checkpoint.film);
  for (const Layer& layer : checkpoint.layers) enter(layer.name, layer.values);
  const std::string head = head_text(checkpoint, entries);
  if (head.size() > MAX_HEAD)
    fail(path, "its head would have " + std::to_string(head.size()) + " bytes", "at most " + std::to_string(MAX_HEAD));
  const std::string lines = prologue(head);
  FileAside aside(path);
  const auto put = [&](const void* bytes, std::size_t count) {
    if (count > 0 && std::fwrite(bytes, 1, count, aside.file()) != count) aside.fail_to_write(errno);
  };
  put(lines.data(), lines.size());
  put(head.data(), head.size());
  for_each_array([&](const char*, bool, const auto& values) { for_each_bytes(values, put); }, checkpoint.film);
  for (const Layer& layer : checkpoint.layers) for_each_bytes(layer.values, put);
  aside.commit();
}

Checkpoint read_checkpoint_head(const fs::path& path) {
  Input input(path);
  CheckpointHead head = read_head(path, input);
  check_arrays(path, head, input.rest());
  return std::move(head.checkpoint);
}

CheckpointSummary summarize_checkpoint(const fs::path& path) {
  Input input(path);
  CheckpointHead head = read_head(path, input);
  const std::uint64_t rest = input.rest();
  check_arrays(path, head, rest);
  check_checksums(path, input, head.arrays);
  const Film& film = head.checkpoint.film;
  CheckpointSummary summary;
  ImageError error(std::size_t{film.width} * film.height);
  look_at_pixels(input, rest, head, [&](const Film& piece, std::size_t i) {
    check_counts(path, piece, i);
    summary.rejected += piece.pixels[i].rejected;
    error.add_to_mean(piece, i);
  });
  look_at_pixels(input, rest, head, [&](const Film& piece, std::size_t i) { error.add_to_error(piece, i); });
  summary.error = error.result();
  for (const ArrayEntry& entry : head.arrays) summary.moments |= entry.name == "moments" && entry.bytes > 0;
  summary.head = std::move(head.checkpoint);
  return summary;
}

Checkpoint read_checkpoint(const fs::path& path, Film film) {
  Input input(path);
  CheckpointHead head = read_head(path, input);
  const std::uint64_t bytes = input.rest();
  check_arrays(path, head, bytes);
  for_each_array([](const char*, bool, auto& to, auto& from) { to.swap(from); }, head.checkpoint.film, film);
  try {
    read_arrays(path, input, head.arrays, head.checkpoint);
  } catch (const std::bad_alloc&) {
    fail(path, "there is not enough memory for its film", std::to_string(bytes) + " bytes");
  }
  return std::move(head.checkpoint);
}

}  // namespace oclair
