// One XML file while it is read: where its elements stand, and the checks that hold for all of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace oclair {

struct Source {
  std::string name;                                // as messages show it
  std::vector<std::size_t> lines;                  // offsets of the newlines
  std::vector<std::filesystem::path> search_path;  // for what this file names
};

// "file:line" of an offset into the text, and of a node.
std::string where(const Source& source, std::ptrdiff_t offset);
std::string where(const Source& source, pugi::xml_node node);

// <name>, for messages.
std::string in_brackets(pugi::xml_node node);

// Comments and processing instructions.
bool says_nothing(pugi::xml_node node);

// Refuses attributes that are not listed or given twice, and the absence of those marked with '!'.
void check_attributes(const Source& source, pugi::xml_node node, std::initializer_list<const char*> allowed);

// Refuses elements and text inside the node.
void refuse_children(const Source& source, pugi::xml_node node);

}  // namespace oclair
