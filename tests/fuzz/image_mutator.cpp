// PNG: changes the bytes of the file, or the rows in its data, and makes the checksums of the chunks right. Other formats
// have none.
#include <utility>

#include "mutator.h"

using namespace oclair::test;

namespace {

constexpr std::size_t SIGNATURE = 8, AROUND = 12;  // bytes of a chunk that are not its data: length, type, checksum

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string covered = type + data;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(covered.data()), static_cast<uInt>(covered.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + covered + big_endian(static_cast<std::uint32_t>(checksum));
}

// visit(type, data) for each whole chunk; returns where they end.
template <class Visit>
std::size_t visit_chunks(const std::string& file, Visit visit) {
  std::size_t at = SIGNATURE;
  while (file.size() - at >= AROUND) {
    const std::size_t length = big_endian(std::string_view(file).substr(at));
    if (length > file.size() - at - AROUND) break;
    visit(file.substr(at + 4, 4), file.substr(at + 8, length));
    at += length + AROUND;
  }
  return at;
}

std::string with_changed_rows(const std::string& file) {
  constexpr std::size_t MOST = 1 << 16;
  std::string data, result = file.substr(0, SIGNATURE);
  visit_chunks(file, [&](const std::string& type, const std::string& bytes) { data += type == "IDAT" ? bytes : ""; });
  const auto rows = inflated(data, MOST);
  if (!rows) return file;
  std::string changed = chunk("IDAT", deflated(mutated(rows->bytes, MOST)));
  visit_chunks(file, [&](const std::string& type, const std::string& bytes) {
    result += type == "IDAT" ? std::exchange(changed, "") : chunk(type, bytes);
  });
  return result;
}

std::string with_right_checksums(const std::string& file) {
  std::string result = file.substr(0, SIGNATURE);
  const std::size_t end =
      visit_chunks(file, [&](const std::string& type, const std::string& bytes) { result += chunk(type, bytes); });
  return result + file.substr(end);
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  const std::string file(reinterpret_cast<const char*>(data), size);
  if (!file.starts_with("\x89PNG\r\n\x1a\n") || seed % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string changed = seed % 4 == 1 ? with_changed_rows(file) : mutated(file, max_size);
  return put_back(changed.size() < SIGNATURE ? changed : with_right_checksums(changed), data, size, max_size);
}
