// What a PLY file consists of: its header, and its numbers one after another.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"

namespace oclair {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyReader {
  std::string_view rest;
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
};

[[noreturn]] inline void fail_ply(const std::string& what) { throw MeshFileError(what); }

bool is_integer(Scalar type);

// Cut off the front of the text; empty at its end.
std::string_view next_word(std::string_view& text);

void read_header(PlyReader& reader);

inline std::size_t size_of(Scalar type) {
  constexpr std::size_t SIZES[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return SIZES[static_cast<int>(type)];
}

// The next number of a text.
double read_word(PlyReader& reader, Scalar type);

template <class T>
double decode(const char* bytes, Encoding encoding) {
  char buffer[sizeof(T)];
  std::memcpy(buffer, bytes, sizeof(T));
  const bool host_is_little = std::endian::native == std::endian::little;
  if (host_is_little != (encoding == Encoding::little_endian)) std::reverse(buffer, buffer + sizeof(T));
  T value;
  std::memcpy(&value, buffer, sizeof(T));
  return static_cast<double>(value);
}

// The next number, exactly: doubles hold all of the types.
inline double read_scalar(PlyReader& reader, Scalar type) {
  if (reader.encoding == Encoding::ascii) return read_word(reader, type);
  const std::size_t size = size_of(type);
  if (reader.rest.size() < size) fail_ply("it breaks off");
  const char* const bytes = reader.rest.data();
  reader.rest.remove_prefix(size);
  switch (type) {
    case Scalar::int8:
      return decode<std::int8_t>(bytes, reader.encoding);
    case Scalar::uint8:
      return decode<std::uint8_t>(bytes, reader.encoding);
    case Scalar::int16:
      return decode<std::int16_t>(bytes, reader.encoding);
    case Scalar::uint16:
      return decode<std::uint16_t>(bytes, reader.encoding);
    case Scalar::int32:
      return decode<std::int32_t>(bytes, reader.encoding);
    case Scalar::uint32:
      return decode<std::uint32_t>(bytes, reader.encoding);
    case Scalar::float32:
      return decode<float>(bytes, reader.encoding);
    case Scalar::float64:
      return decode<double>(bytes, reader.encoding);
  }
  fail_ply("a type is not known");
}

// Calls visit(value) for each number of the property; a length that the file cannot hold ends in "it breaks off".
template <typename Visit>
void read_property(PlyReader& reader, const PlyProperty& property, Visit visit) {
  if (!property.count_type) return visit(read_scalar(reader, property.type));
  const double count = read_scalar(reader, *property.count_type);
  if (count < 0.0) fail_ply("the length of a list is negative");
  for (double i = 0.0; i < count; ++i) visit(read_scalar(reader, property.type));
}

}  // namespace oclair
