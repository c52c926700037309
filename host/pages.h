// Memory for arrays that are as large as the scene.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace oclair {

inline constexpr std::size_t HUGE_PAGE = std::size_t{1} << 21;

// Asks for pages of 2 MiB, where the system has them: fewer page faults while the memory is filled, fewer misses of the address
// cache while it is read. A wish: nothing depends on it.
inline void wish_for_huge_pages(void* memory, std::size_t bytes) {
  const auto first = (reinterpret_cast<std::uintptr_t>(memory) + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / HUGE_PAGE * HUGE_PAGE;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

// Large arrays begin with a huge page, small ones with a cache line. Elements are left as they are found: the thread that writes one first pays for its page.
// OpenCL devices that share the host's memory can use it as it is (CL_MEM_USE_HOST_PTR).
template <class T>
struct PageAllocator {
  using value_type = T;
  static constexpr std::size_t CACHE_LINE = 64;

  PageAllocator() = default;
  template <class U>
  PageAllocator(const PageAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > (std::size_t{1} << 62) / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T), alignment = bytes >= 2 * HUGE_PAGE ? HUGE_PAGE : CACHE_LINE;
    const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, whole);
    if (!memory) throw std::bad_alloc();
    wish_for_huge_pages(memory, whole);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) ::new (static_cast<void*>(at)) U;
    else ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  bool operator==(const PageAllocator&) const = default;
};

// resize() leaves new elements of trivial types unset.
template <class T>
using PagedVector = std::vector<T, PageAllocator<T>>;

// Room for that many elements.
template <class Vector>
void reserve_pages(Vector& values, std::size_t count) {
  values.reserve(count);
  wish_for_huge_pages(values.data(), values.capacity() * sizeof(values[0]));
}

}  // namespace oclair
