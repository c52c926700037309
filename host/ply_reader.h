// What a PLY file consists of: its header, and its numbers one after another.
#pragma once

#include <cstdint>
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

// The next number, exactly: doubles hold all of the types.
double read_scalar(PlyReader& reader, Scalar type);

// Calls visit(value) for each number of the property; a length that the file cannot hold ends in "it breaks off".
template <typename Visit>
void read_property(PlyReader& reader, const PlyProperty& property, Visit visit) {
  if (!property.count_type) return visit(read_scalar(reader, property.type));
  const double count = read_scalar(reader, *property.count_type);
  if (count < 0.0) fail_ply("the length of a list is negative");
  for (double i = 0.0; i < count; ++i) visit(read_scalar(reader, property.type));
}

}  // namespace oclair
