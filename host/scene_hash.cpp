#include "scene_hash.h"

#include "xxh3.h"

namespace oclair {
namespace {

// With its length, so that no two lists of texts run into the same bytes.
void add_text(Xxh3& hash, const std::string& text) {
  const std::string framed = std::to_string(text.size()) + ":" + text;
  hash.add(framed.data(), framed.size());
}

}  // namespace

std::string scene_hash(const World& world, const Definitions& definitions) {
  Xxh3 hash;
  for (const SceneFile& file : world.files) {
    add_text(hash, file.name);
    add_text(hash, file.checksum);
  }
  add_text(hash, "definitions");
  for (const auto& [name, value] : definitions) {
    add_text(hash, name);
    add_text(hash, value);
  }
  return hash.digits();
}

}  // namespace oclair
