#include "substitution.h"

#include <pugixml.hpp>

#include "document.h"
#include "error.h"

namespace oclair {

namespace {

constexpr std::size_t MAX_VALUE = 4096;                         // bytes of an attribute after substitution
constexpr std::size_t MAX_SUBSTITUTED = std::size_t{16} << 20;  // bytes of all of them together
constexpr std::size_t MAX_NAME = 256;

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool is_name(const std::string& name) {
  if (name.empty() || name.size() > MAX_NAME) return false;
  for (const char c : name)
    if (!is_name_character(c)) return false;
  return true;
}

std::string substituted(Substitution& substitution, const std::string& text, const std::string& where) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
      result += '$';
      i += 2;
      continue;
    }
    if (text[i] != '$') {
      result += text[i++];
      continue;
    }
    std::size_t end = i + 1;
    while (end < text.size() && end - i <= MAX_NAME && is_name_character(text[end])) ++end;
    auto found = substitution.parameters.end();
    std::size_t length = end - i - 1;
    for (; length > 0 && found == substitution.parameters.end(); --length)
      found = substitution.parameters.find(text.substr(i + 1, length));
    if (found == substitution.parameters.end())
      refuse(where, "the parameter \"$" + text.substr(i + 1, end - i - 1) +
                        "\" is not defined (define it with <default> before this line, or on the command line)");
    found->second.used = true;
    result += found->second.value;
    i += 1 + found->first.size();
    if (result.size() > MAX_VALUE) break;
  }
  if (result.size() > MAX_VALUE)
    refuse(where, "an attribute is longer than " + std::to_string(MAX_VALUE) + " bytes after substitution");
  return result;
}

}  // namespace

Substitution make_substitution(const Definitions& definitions) {
  Substitution substitution;
  for (const auto& [name, value] : definitions) {
    if (!is_name(name)) throw Error(Exit::usage, "definition of \"" + name + "\": a name consists of letters, digits and _");
    if (value.find('$') != std::string::npos)
      throw Error(Exit::usage, "definition of \"" + name + "\": a value cannot hold a $");
    substitution.parameters[name] = {value, true, false};
  }
  return substitution;
}

void add_default(Substitution& substitution, const std::string& name, const std::string& value, const std::string& where) {
  if (!is_name(name)) refuse(where, "<default>: the name \"" + name + "\" does not consist of letters, digits and _");
  substitution.parameters.emplace(name, Parameter{value, false, false});
}

void substitute(Substitution& substitution, pugi::xml_node node, const std::string& where) {
  for (auto attribute : node.attributes()) {
    const std::string text = attribute.value();
    if (text.find('$') == std::string::npos) continue;
    const std::string value = substituted(substitution, text, where);
    substitution.substituted_bytes += value.size();
    if (substitution.substituted_bytes > MAX_SUBSTITUTED) refuse(where, "more than 16 MiB of attributes hold parameters");
    attribute.set_value(value.c_str());
  }
}

void check_definitions(const Substitution& substitution) {
  for (const auto& [name, parameter] : substitution.parameters)
    if (parameter.defined_by_user && !parameter.used)
      throw Error(Exit::usage, "definition of \"" + name + "\": the scene does not use $" + name);
}

}  // namespace oclair
