// Serialized meshes: changes what the first zlib stream holds, the others and the dictionary stay as they are. One time in
// four the bytes of the file instead.
#include "mutator.h"

using namespace oclair::test;

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  constexpr std::size_t HEADER = 4, MOST = 1 << 16;
  const std::string file(reinterpret_cast<const char*>(data), size);
  const auto stream = size < HEADER ? std::nullopt : inflated(std::string_view(file).substr(HEADER), MOST);
  if (!stream || seed % 4 == 0) return LLVMFuzzerMutate(data, size, max_size);
  return put_back(
      file.substr(0, HEADER) + deflated(mutated(stream->bytes, MOST)) + file.substr(HEADER + stream->compressed_size), data,
      size, max_size);
}
