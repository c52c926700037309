#include "material.h"

#include <set>

namespace oclair {

bool has_opacity(const Material& m) { return m.transparency > 0.0f || m.opacity_texture != 0; }

bool lets_light_through(const Material& m) { return m.kind == MATERIAL_DIELECTRIC || m.kind == MATERIAL_THIN_DIELECTRIC; }

bool any_material(const std::vector<Material>& materials, uint index, const std::function<bool(const Material&)>& holds) {
  std::vector<uint> left = {index};
  std::set<uint> seen;
  while (!left.empty()) {
    const uint i = left.back();
    left.pop_back();
    if (i == NONE || !seen.insert(i).second) continue;
    const Material& m = materials[i];
    if (holds(m)) return true;
    if (m.kind == MATERIAL_BLEND) left.insert(left.end(), {m.first, m.second});
  }
  return false;
}

}  // namespace oclair
