#include "integrator_reader.h"

#include <limits>

#include "property.h"

namespace oclair {

namespace {

constexpr std::int64_t MAX_UINT = std::numeric_limits<uint>::max();

void read_path(Element& element, WorldIntegrator& integrator) {
  const auto max_depth = integer_property(element, "max_depth", -1, -1, MAX_UINT);
  integrator.max_depth = max_depth < 0 ? std::numeric_limits<uint>::max() : static_cast<uint>(max_depth);
  integrator.rr_depth = static_cast<uint>(integer_property(element, "rr_depth", 5, 1, MAX_UINT));
}

void read_direct(Element& element, World& world) {
  for (const char* other : {"emitter_samples", "bsdf_samples"})
    if (has_property(element, "shading_samples") && has_property(element, other))
      refuse(where_is(element, other),
             "\"shading_samples\" and \"" + std::string(other) + "\" of " + describe(element) + " exclude each other");
  for (const char* name : {"shading_samples", "emitter_samples", "bsdf_samples"}) {
    const auto count = integer_property(element, name, 1, 0, MAX_UINT);
    if (count == 0)
      refuse(where_is(element, name), "\"" + std::string(name) + "\" of " + describe(element) +
                                          " is 0, which is not supported (supported: 1 or more)");
    if (count != 1)
      world.warnings.push_back(where_is(element, name) + ": \"" + name + "\" of " + describe(element) +
                               " changes only the noise; 1 is used, raise sample_count instead");
  }
  world.integrator.max_depth = 2;
}

}  // namespace

void read_integrator(Document& document, std::uint32_t index, World& world) {
  auto& element = document.elements[index];
  world.integrator.hide_emitters |= boolean_property(element, "hide_emitters", false);
  if (element.type == "moment") {
    if (element.children.size() != 1)
      refuse(element.where, describe(element) + " holds " + std::to_string(element.children.size()) +
                                " objects, one <integrator> is expected");
    const auto& child = element.children[0];
    const auto& nested = document.elements[child.element];
    if (nested.tag != "integrator" || nested.type == "moment")
      refuse(child.where, describe(nested) + " is not supported in " + describe(element) +
                              " (supported: integrator of type path, direct)");
    world.integrator.moments = true;
    return read_integrator(document, child.element, world);
  }
  if (!element.children.empty()) refuse(element.children[0].where, "nothing may be nested in " + describe(element));
  if (element.type == "path")
    read_path(element, world.integrator);
  else if (element.type == "direct")
    read_direct(element, world);
  else
    refuse(element.where, describe(element) + " is not supported (supported: direct, moment, path)");
}

}  // namespace oclair
