// What the mutators of formats with checksums share: they change what a checksum covers, then make the checksum right, so
// that fuzzing gets behind it.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

// Both are libFuzzer's: changes up to `size` bytes in place and returns how many there are now, at most max_size.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed);

namespace oclair::test {

inline std::string mutated(std::string bytes, std::size_t max_size) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max(max_size, size));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
  return bytes;
}

// How long it is now; a result that does not fit is thrown away.
inline std::size_t put_back(const std::string& bytes, std::uint8_t* data, std::size_t size, std::size_t max_size) {
  if (bytes.size() > max_size) return size;
  std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}

struct Inflated {
  std::string bytes;
  std::size_t compressed_size;
};

// Of the zlib stream at the beginning; nothing if there is none or it is longer than `most`.
inline std::optional<Inflated> inflated(std::string_view compressed, std::size_t most) {
  Inflated result{std::string(most, '\0'), 0};
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(compressed.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.bytes.data());
  stream.avail_out = static_cast<uInt>(most);
  const int end = inflate(&stream, Z_FINISH);
  result.bytes.resize(stream.total_out);
  result.compressed_size = stream.total_in;
  inflateEnd(&stream);
  if (end != Z_STREAM_END) return {};
  return result;
}

inline std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 1);
  result.resize(size);
  return result;
}

}  // namespace oclair::test
