// A fuzz target of libFuzzer: one reader (OCLAIR_FUZZ_READER, from ../file_readers.h) and whatever bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>

#include "../file_readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string refusal = oclair::test::OCLAIR_FUZZ_READER({reinterpret_cast<const char*>(data), size});
  if (refusal.find('\n') == std::string::npos) return 0;
  std::cerr << "a refusal of several lines: " << refusal << "\n";
  std::abort();
}
