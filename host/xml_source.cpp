#include "xml_source.h"

#include <algorithm>
#include <set>

#include "document.h"

namespace oclair {

std::string where(const Source& source, std::ptrdiff_t offset) {
  const auto line = std::lower_bound(source.lines.begin(), source.lines.end(),
                                     static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
  return source.name + ":" + std::to_string(line - source.lines.begin() + 1);
}

std::string where(const Source& source, pugi::xml_node node) { return where(source, node.offset_debug()); }

std::string in_brackets(pugi::xml_node node) { return std::string("<") + node.name() + ">"; }

void check_attributes(const Source& source, pugi::xml_node node, std::initializer_list<const char*> allowed) {
  std::string list;
  for (const char* name : allowed) list += (list.empty() ? "" : ", ") + std::string(name + (*name == '!'));
  std::set<std::string> seen;
  for (const auto attribute : node.attributes()) {
    if (std::none_of(allowed.begin(), allowed.end(),
                     [&](const char* name) { return std::string(name + (*name == '!')) == attribute.name(); }))
      refuse(where(source, node), "attribute \"" + std::string(attribute.name()) + "\" of " + in_brackets(node) +
                                      " is not supported (supported: " + list + ")");
    if (!seen.insert(attribute.name()).second)
      refuse(where(source, node),
             "attribute \"" + std::string(attribute.name()) + "\" of " + in_brackets(node) + " is given twice");
  }
  for (const char* name : allowed)
    if (*name == '!' && !node.attribute(name + 1))
      refuse(where(source, node), in_brackets(node) + " lacks the attribute \"" + (name + 1) + "\"");
}

void refuse_children(const Source& source, pugi::xml_node node) {
  for (const auto child : node.children())
    if (!says_nothing(child)) refuse(where(source, child), "nothing may be nested in " + in_brackets(node));
}

bool says_nothing(pugi::xml_node node) { return node.type() == pugi::node_comment || node.type() == pugi::node_pi; }

}  // namespace oclair
