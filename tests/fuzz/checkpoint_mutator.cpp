// Checkpoints: changes the head or the arrays, and makes the checksums right: that of the head, and those of the arrays that
// it lists if it still is JSON. One time in eight the bytes of the file instead.
#include <nlohmann/json.hpp>

#include "../../host/xxh3.h"
#include "mutator.h"

using namespace oclair::test;

namespace {

const std::string FORMAT = "oclair checkpoint 1\n";
constexpr std::size_t DIGITS = 8, CHECKSUM = 32;

// With the checksums of the arrays that follow.
std::string with_right_arrays(const std::string& head, const std::string& arrays) {
  nlohmann::json json = nlohmann::json::parse(head, nullptr, false);
  if (!json.is_object() || !json["arrays"].is_array()) return head;
  std::size_t at = 0;
  for (auto& entry : json["arrays"]) {
    if (!entry.is_array() || entry.size() != 3 || !entry[1].is_number_unsigned()) return head;
    const auto bytes = entry[1].get<std::size_t>();
    if (bytes > arrays.size() - at) return head;
    entry[2] = oclair::xxh3_digits(arrays.data() + at, bytes);
    at += bytes;
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  const std::string file(reinterpret_cast<const char*>(data), size);
  const std::size_t prologue = FORMAT.size() + DIGITS + 1 + CHECKSUM + 1;
  const std::size_t end = file.find("}\n", std::min(prologue, size));
  if (!file.starts_with(FORMAT) || end == std::string::npos || seed % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::string head = file.substr(prologue, end + 2 - prologue), arrays = file.substr(end + 2);
  if (seed % 4 == 1)
    arrays = mutated(arrays, arrays.size() + 64);
  else
    head = mutated(head, head.size() + 256);
  head = with_right_arrays(head, arrays);
  const std::string digits = std::to_string(head.size());
  if (digits.size() > DIGITS) return size;
  return put_back(FORMAT + std::string(DIGITS - digits.size(), '0') + digits + " " +
                      oclair::xxh3_digits(head.data(), head.size()) + "\n" + head + arrays,
                  data, size, max_size);
}
