// OpenEXR's input from a C stream.
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace oclair {

using InputFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// Null if it cannot be opened.
inline InputFile open_input(const std::filesystem::path& path) { return {std::fopen(path.c_str(), "rb"), &std::fclose}; }

class FileStream : public Imf::IStream {
 public:
  explicit FileStream(std::FILE* file) : Imf::IStream("it"), file_(file) {}

  bool read(char to[], int count) override {
    if (std::fread(to, 1, static_cast<std::size_t>(count), file_) != static_cast<std::size_t>(count))
      throw std::runtime_error("it breaks off");
    return true;
  }
  std::uint64_t tellg() override { return static_cast<std::uint64_t>(ftello(file_)); }
  void seekg(std::uint64_t position) override {
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) throw std::runtime_error("it breaks off");
  }

 private:
  std::FILE* file_;
};

}  // namespace oclair
