#include "exr_headers.h"

#include <ImfVersion.h>
#include <ImfXdr.h>

#include <stdexcept>
#include <string>

namespace oclair {
namespace {

class HeaderWalk {
 public:
  HeaderWalk(Imf::IStream& stream, std::uint64_t size) : stream_(stream), size_(size) {}

  int integer() {
    require(4);
    int value = 0;
    Imf::Xdr::read<Imf::StreamIO>(stream_, value);
    return value;
  }

  // Names of attributes and of their types; both have at most 255 bytes.
  std::string name() {
    std::string name;
    for (char byte;; name += byte) {
      require(1);
      stream_.read(&byte, 1);
      if (byte == 0) return name;
      if (name.size() == 255) throw std::runtime_error("a name in its header is too long");
    }
  }

  void require(std::uint64_t bytes) {
    if (bytes > size_ - stream_.tellg()) throw std::runtime_error("it breaks off in its header");
  }

  // True if there was one, false at the end of the header.
  bool attribute() {
    if (name().empty()) return false;
    const std::string type = name();
    const int bytes = integer();
    if (bytes < 0) throw std::runtime_error("an attribute has a negative size");
    require(static_cast<std::uint64_t>(bytes));
    const std::uint64_t end = stream_.tellg() + static_cast<std::uint64_t>(bytes);
    if (type == "stringvector") strings(end);
    stream_.seekg(end);
    return true;
  }

 private:
  void strings(std::uint64_t end) {
    while (stream_.tellg() < end) {
      const int bytes = integer();
      const std::uint64_t at = stream_.tellg();
      if (bytes < 0 || at > end || static_cast<std::uint64_t>(bytes) > end - at)
        throw std::runtime_error("a string in its header is too long");
      stream_.seekg(at + static_cast<std::uint64_t>(bytes));
    }
  }

  Imf::IStream& stream_;
  std::uint64_t size_;
};

}  // namespace

void check_exr_headers(Imf::IStream& stream, std::uint64_t size) {
  stream.seekg(0);
  HeaderWalk walk(stream, size);
  if (walk.integer() != Imf::MAGIC) throw std::runtime_error("it does not begin as an OpenEXR file does");
  const bool several = Imf::isMultiPart(walk.integer());
  do {
    if (!walk.attribute()) break;  // the headers of several parts end with an empty one
    while (walk.attribute()) {
    }
  } while (several);
  stream.seekg(0);
}

}  // namespace oclair
