// Arrays as large as the scene, most of which become buffers of the device.
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

// Asks for pages of 2 MiB, where the system has them, before the memory is first touched: fewer misses of the address cache
// while it is read at random. Not for what lives briefly: such pages cost more to get. A wish: nothing depends on it.
inline void wish_for_huge_pages(void* memory, std::size_t bytes) {
  constexpr std::size_t HUGE_PAGE = std::size_t{1} << 21;
  const auto first = (reinterpret_cast<std::uintptr_t>(memory) + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / HUGE_PAGE * HUGE_PAGE;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

// Arrays begin with a cache line. Elements are left as they are found: the thread that writes one first pays for its page.
// Devices that share the host's memory can use them as they are (CL_MEM_USE_HOST_PTR).
template <class T>
struct BufferAllocator {
  using value_type = T;
  static constexpr std::size_t CACHE_LINE = 64;

  BufferAllocator() = default;
  template <class U>
  BufferAllocator(const BufferAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > (std::size_t{1} << 62) / sizeof(T)) throw std::bad_array_new_length();
    void* const memory = std::aligned_alloc(CACHE_LINE, (count * sizeof(T) + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE);
    if (!memory) throw std::bad_alloc();
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) ::new (static_cast<void*>(at)) U;
    else ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  bool operator==(const BufferAllocator&) const = default;
};

// resize() leaves new elements of trivial types unset.
template <class T>
using BufferVector = std::vector<T, BufferAllocator<T>>;

}  // namespace oclair
