// Scenes: changes the tree of elements, which changed bytes would seldom leave well-formed. One time in four the bytes
// instead.
#include <iterator>
#include <pugixml.hpp>
#include <random>
#include <sstream>
#include <vector>

#include "mutator.h"

using namespace oclair::test;

namespace {

using Random = std::minstd_rand;

std::size_t below(Random& random, std::size_t count) { return random() % count; }

std::vector<pugi::xml_node> all_elements(const pugi::xml_document& document) {
  std::vector<pugi::xml_node> result;
  for (auto node = document.document_element(); node;) {
    if (node.type() == pugi::node_element) result.push_back(node);
    if (node.first_child()) {
      node = node.first_child();
      continue;
    }
    while (node && !node.next_sibling()) node = node.parent();
    node = node.next_sibling();
  }
  return result;
}

// What readers of values may stumble over.
const char* const VALUES[] = {"0",
                              "-1",
                              "1",
                              "1e-310",
                              "1e308",
                              "-1e308",
                              "1e30",
                              "1e-30",
                              "1e6",
                              "65536",
                              "1e300",
                              "0.5",
                              "180",
                              "90",
                              "4294967296",
                              "9223372036854775807",
                              "true",
                              "none",
                              "a.obj",
                              "a.ply",
                              "a.png",
                              "a.exr",
                              "a.serialized",
                              "included.xml",
                              "0 0 0",
                              "0,1,0",
                              "1 1 1",
                              "0.1, 0.2, 0.3",
                              "$a",
                              "a",
                              "",
                              "vertex_color",
                              "1e-200 1e200 1",
                              "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
                              "1e200 0 0 0 0 1e-200 0 0 0 0 1 0 0 0 0 1"};

void change_value(Random& random, pugi::xml_node node) {
  std::vector<pugi::xml_attribute> attributes(node.attributes_begin(), node.attributes_end());
  if (attributes.empty()) return;
  auto attribute = attributes[below(random, attributes.size())];
  if (below(random, 3) == 0)
    attribute.set_value(mutated(attribute.value(), 64).c_str());
  else
    attribute.set_value(VALUES[below(random, std::size(VALUES))]);
}

void change(Random& random, const pugi::xml_document& document) {
  const auto elements = all_elements(document);
  if (elements.size() < 2) return;
  auto node = elements[1 + below(random, elements.size() - 1)], other = elements[below(random, elements.size())];
  switch (below(random, 7)) {
    case 0:
      node.parent().remove_child(node);
      break;
    case 1:
      node.parent().insert_copy_after(node, node);
      break;
    case 2:
      other.append_copy(node);
      break;
    case 3:
      other.prepend_copy(node);
      break;
    case 4:
      node.set_name(other.name());
      break;
    default:
      change_value(random, node);
  }
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  Random random(seed);
  pugi::xml_document document;
  if (below(random, 4) == 0 || !document.load_buffer(data, size)) return LLVMFuzzerMutate(data, size, max_size);
  for (std::size_t changes = 1 + below(random, 4); changes > 0; --changes) change(random, document);
  std::ostringstream text;
  document.save(text, "", pugi::format_raw);
  return put_back(text.str(), data, size, max_size);
}
