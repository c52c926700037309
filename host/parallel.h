// Loops over all cores, with the threads of TBB, which Embree brings and uses too.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <exception>
#include <mutex>

namespace oclair {

// Calls body(first, end) for pieces that make up [0, count), in any order. How it is cut differs from run to run: nothing that
// body writes may depend on it. If body throws, the exception of the first piece that threw comes out: that of the loop without
// threads, if body goes through its piece in order.
// A loop of up to `least` is not cut: that should take some 10 us, well above what a task costs.
template <class Body>
void parallel_pieces(std::size_t count, const Body& body, std::size_t least = 4096) {
  if (count <= least) return count == 0 ? void() : body(std::size_t{0}, count);
  std::mutex mutex;
  std::size_t failed = count;
  std::exception_ptr error;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, least), [&](const tbb::blocked_range<std::size_t>& piece) {
    try {
      body(piece.begin(), piece.end());
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (piece.begin() >= failed) return;
      failed = piece.begin();
      error = std::current_exception();
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace oclair
