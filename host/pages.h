// Memory for arrays that are as large as the scene.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace oclair {

// Whole pages, of 2 MiB where the array is large and the system has them: fewer page faults while it is filled, fewer misses of the
// address cache while it is read. Elements are left as they are found: the thread that writes one first pays for its page.
// OpenCL devices that share the host's memory can use it as it is (CL_MEM_USE_HOST_PTR).
template <class T>
struct PageAllocator {
  using value_type = T;
  static constexpr std::size_t PAGE = 4096, HUGE_PAGE = std::size_t{1} << 21;

  PageAllocator() = default;
  template <class U>
  PageAllocator(const PageAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > (std::size_t{1} << 62) / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T), page = bytes >= 2 * HUGE_PAGE ? HUGE_PAGE : PAGE;
    const std::size_t whole = (bytes + page - 1) / page * page;
    void* const memory = std::aligned_alloc(page, whole);
    if (!memory) throw std::bad_alloc();
    if (page == HUGE_PAGE) madvise(memory, whole, MADV_HUGEPAGE);  // a wish: without it the pages are small
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

}  // namespace oclair
