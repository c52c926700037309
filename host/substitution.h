// $name in the attributes of a scene: values from <default> and from the command line.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "reader.h"

namespace pugi {
class xml_node;
}

namespace oclair {

struct Parameter {
  std::string value;
  bool defined_by_user = false;
  bool used = false;
};

struct Substitution {
  std::map<std::string, Parameter> parameters;  // names consist of letters, digits and _
  std::size_t substituted_bytes = 0;            // of all values so far: bounded, so that $a$a$a... cannot fill the memory
};

// Throws Error(Exit::usage) if a name or a value cannot be one.
Substitution make_substitution(const Definitions& definitions);

// <default>: holds from here on, unless the command line or an earlier default has set it.
void add_default(Substitution& substitution, const std::string& name, const std::string& value, const std::string& where);

// Replaces $name in every attribute of the node; the longest known name wins, \$ stands for a dollar sign. Refuses a name
// that is not known at this point of the file.
void substitute(Substitution& substitution, pugi::xml_node node, const std::string& where);

// Throws Error(Exit::usage) if the scene did not use a definition of the command line.
void check_definitions(const Substitution& substitution);

}  // namespace oclair
