// XXH3 of 128 bits (Collet, xxhash.com): detects damage and tells inputs apart; it does not protect from forgery.
#pragma once

#include <cstddef>
#include <string>

struct XXH3_state_s;

namespace oclair {

class Xxh3 {
 public:
  Xxh3();
  Xxh3(const Xxh3&) = delete;
  Xxh3& operator=(const Xxh3&) = delete;
  ~Xxh3();

  Xxh3& add(const void* bytes, std::size_t count);

  // 32 hexadecimal digits, as `xxhsum -H2` prints them.
  std::string digits() const;

 private:
  XXH3_state_s* state_;
};

inline std::string xxh3_digits(const void* bytes, std::size_t count) { return Xxh3().add(bytes, count).digits(); }

}  // namespace oclair
