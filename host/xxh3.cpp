#include "xxh3.h"

#include <xxhash.h>

#include <new>

namespace oclair {

Xxh3::Xxh3() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_);
}

Xxh3::~Xxh3() { XXH3_freeState(state_); }

Xxh3& Xxh3::add(const void* bytes, std::size_t count) {
  XXH3_128bits_update(state_, bytes, count);
  return *this;
}

std::string Xxh3::digits() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_));
  std::string digits;
  for (const unsigned char byte : canonical.digest) digits += {"0123456789abcdef"[byte >> 4], "0123456789abcdef"[byte & 15]};
  return digits;
}

}  // namespace oclair
