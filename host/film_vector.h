// The arrays of a film: in memory or, where it is too large for that, in files without a name.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace oclair {

// Where arrays lie: in memory (null), or each in a file of its own in this directory, whose pages are mapped. Such a file takes its room
// on the disk when it is made, so that a full disk is an error then and not a signal later. It never has a name, or loses it at once:
// it ends with its array, or with the process, however that ends.
using FilmDirectory = std::shared_ptr<const std::filesystem::path>;

// Zeros. Throws std::bad_alloc, or Error(Exit::render_failed) if there can be no such file.
void* allocate_film(std::size_t bytes, const FilmDirectory& directory);
void free_film(void* memory, std::size_t bytes, const FilmDirectory& directory);

// Unmaps the pages of a mapped file that hold these bytes: they stay in the file, and are mapped again when they are used.
void release_pages(const void* first, std::size_t bytes);

// Elements that are made without a value are left as they were found: zero. A copy lies where its original does.
template <class T>
struct FilmAllocator {
  static_assert(std::is_trivially_copyable_v<T>);
  using value_type = T;
  using propagate_on_container_copy_assignment = std::true_type;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  FilmAllocator() = default;
  explicit FilmAllocator(FilmDirectory where) : directory(std::move(where)) {}
  template <class U>
  FilmAllocator(const FilmAllocator<U>& other) : directory(other.directory) {}

  T* allocate(std::size_t count) {
    if (count > (std::size_t{1} << 62) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_film(count * sizeof(T), directory));
  }
  void deallocate(T* memory, std::size_t count) { free_film(memory, count * sizeof(T), directory); }

  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) ::new (static_cast<void*>(at)) U;
    else ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  bool operator==(const FilmAllocator&) const = default;

  FilmDirectory directory;
};

template <class T>
using FilmVector = std::vector<T, FilmAllocator<T>>;

// Lets go of the memory behind those of the elements [first, end) that an array in a file has; to one in memory it does nothing.
template <class T>
void release(const FilmVector<T>& array, std::size_t first, std::size_t end) {
  end = std::min(end, array.size());  // what lies behind the array is somebody else's
  if (array.get_allocator().directory && first < end) release_pages(array.data() + first, (end - first) * sizeof(T));
}
template <class T>
void release(const std::vector<T>&, std::size_t, std::size_t) {}

// Elements that are in memory at a time, of an array in a file that is gone through from its start to its end: 2 to 5 MB.
inline constexpr std::size_t FILM_PIECE = std::size_t{1} << 15;

// Calls body(first, end) for pieces that make up [0, count), in order, and lets go behind it of arrays, or films, of so many elements.
template <class Body, class... Arrays>
void for_each_piece(std::size_t count, const Body& body, const Arrays&... arrays) {
  for (std::size_t first = 0; first < count; first += FILM_PIECE) {
    const std::size_t end = std::min(count, first + FILM_PIECE);
    body(first, end);
    (release(arrays, first, end), ...);
  }
}

// The same, calling body(i) for each.
template <class Body, class... Arrays>
void for_each_element(std::size_t count, const Body& body, const Arrays&... arrays) {
  for_each_piece(count, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) body(i);
  }, arrays...);
}

}  // namespace oclair
