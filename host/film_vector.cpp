#include "film_vector.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "error.h"
#include "file_aside.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& directory, std::size_t bytes, int error) {
  throw Error(Exit::render_failed, directory.string() + ": " + std::to_string((bytes + 0xfffff) >> 20) +
                                       " MiB of the film cannot lie here: " + system_message(error) +
                                       ", expected a directory with room for a file, or a --host-memory that holds the film");
}

// Open for reading and writing, and gone when it is closed and no longer mapped; below 0 with errno.
int open_nameless(const fs::path& directory) {
  const int descriptor = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return descriptor;
  std::string name = (directory / "oclair-film.XXXXXX").string();  // NFS and others have no files without a name
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

void* map_new_file(const fs::path& directory, std::size_t bytes) {
  const int descriptor = open_nameless(directory);
  if (descriptor < 0) fail(directory, bytes, errno);
  int error = 0;
  do error = posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  while (error == EINTR);
  void* memory = nullptr;
  if (error == 0) {
    memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED) error = errno;
  }
  close(descriptor);
  if (error != 0) fail(directory, bytes, error);
  return memory;
}

}  // namespace

void* allocate_film(std::size_t bytes, const FilmDirectory& directory) {
  if (directory) return map_new_file(*directory, bytes);
  void* const memory = std::calloc(bytes, 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void free_film(void* memory, std::size_t bytes, const FilmDirectory& directory) {
  if (directory) munmap(memory, bytes);
  else std::free(memory);
}

void release_pages(const void* first, std::size_t bytes) {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(first) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(first) + bytes;  // the system rounds it up
  madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);  // of a shared mapping: what was written stays, in the file
}

}  // namespace oclair
