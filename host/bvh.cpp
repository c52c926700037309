#include "bvh.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "embree.h"
#include "error.h"

namespace oclair {
namespace {

constexpr int max_width = 8;
constexpr unsigned max_leaf_size = 32;
constexpr unsigned max_tree_depth = 1024;  // Embree's default of 32 fails on geometric progressions; real trees reach 200

// The tree as Embree's callbacks make it, in Embree's own arena; flattened afterwards and freed with it.
struct BuildNode {
  int count = 0;  // children; of a leaf: primitives
  bool leaf = false;
  bool quadric = false;
  RTCBounds bounds[max_width];
  BuildNode* child[max_width];
};
struct BuildLeaf : BuildNode {
  uint primitive[max_leaf_size];
};

BuildNode* create_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count, bool quadric) {
  assert(count <= max_leaf_size);
  auto* leaf = new (rtcThreadLocalAlloc(arena, sizeof(BuildLeaf), 16)) BuildLeaf;
  leaf->leaf = true;
  leaf->quadric = quadric;
  leaf->count = static_cast<int>(count);
  for (std::size_t i = 0; i < count; ++i) leaf->primitive[i] = primitives[i].primID;
  return leaf;
}

void* create_triangle_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  return create_leaf(arena, primitives, count, false);
}

void* create_quadric_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  return create_leaf(arena, primitives, count, true);
}

void* create_node(RTCThreadLocalAllocator arena, unsigned count, void*) {
  auto* node = new (rtcThreadLocalAlloc(arena, sizeof(BuildNode), 16)) BuildNode;
  node->count = static_cast<int>(count);
  return node;
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<BuildNode*>(node)->child[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<BuildNode*>(node)->bounds[i] = *bounds[i];
}

void report(void* message, RTCError, const char* text) {
  if (message) *static_cast<std::string*>(message) = text;
}

// An Embree device and a BVH, whose arena the tree lives in.
struct Builder {
  std::string message;
  RTCDevice device;
  RTCBVH bvh;

  Builder() : device(rtcNewDevice(nullptr)), bvh(nullptr) {
    if (!device) throw Error(Exit::render_failed, "Embree: no device; expected a CPU that Embree supports");
    rtcSetDeviceErrorFunction(device, report, &message);
    bvh = rtcNewBVH(device);
  }
  Builder(const Builder&) = delete;
  Builder& operator=(const Builder&) = delete;
  ~Builder() {
    if (bvh) rtcReleaseBVH(bvh);
    rtcReleaseDevice(device);
  }
};

BuildNode* build_tree(Builder& builder, std::vector<RTCBuildPrimitive>& primitives, int width, bool quadrics) {
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = width;
  arguments.maxDepth = max_tree_depth;
  arguments.sahBlockSize = quadrics ? 1 : width;
  arguments.minLeafSize = quadrics ? 1 : width;
  arguments.maxLeafSize = quadrics ? 1 : std::min<unsigned>(max_leaf_size, 4 * width);
  arguments.intersectionCost = 0.5f;  // of one triangle to one box test: a block tests its lanes at once
  arguments.bvh = builder.bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = quadrics ? create_quadric_leaf : create_triangle_leaf;
  auto* root = static_cast<BuildNode*>(rtcBuildBVH(&arguments));
  if (!root)
    throw Error(Exit::render_failed, "Embree: cannot build a BVH over " + std::to_string(primitives.size()) +
                                         " primitives: " + (builder.message.empty() ? "no reason given" : builder.message));
  return root;
}

RTCBuildPrimitive primitive_of(const float low[3], const float high[3], std::size_t index) {
  return {low[0], low[1], low[2], 0u, high[0], high[1], high[2], static_cast<uint>(index)};
}

std::vector<RTCBuildPrimitive> triangle_primitives(const Scene& scene) {
  std::vector<RTCBuildPrimitive> primitives(scene.triangles.size());
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const packed_uint3 t = scene.triangles[i];
    const packed_float3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
    const float low[3] = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    const float high[3] = {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
    primitives[i] = primitive_of(low, high, i);
  }
  return primitives;
}

std::vector<RTCBuildPrimitive> quadric_primitives(const Scene& scene) {
  std::vector<RTCBuildPrimitive> primitives;
  for (std::size_t i = 0; i < scene.quadrics.size(); ++i) {
    const Quadric& q = scene.quadrics[i];
    glm::dmat4 to_world(1.0);
    const packed_float3* axes[3] = {&q.axis_x, &q.axis_y, &q.axis_z};
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 axis(axes[c]->x, axes[c]->y, axes[c]->z);
      to_world[c] = glm::dvec4(axis / glm::dot(axis, axis), 0.0);
    }
    to_world[3] = glm::dvec4(q.center.x, q.center.y, q.center.z, 1.0);
    constexpr Geometry geometry[] = {Geometry::sphere, Geometry::disk, Geometry::cylinder};
    const Bounds box = quadric_bounds(geometry[q.kind], to_world);
    float low[3], high[3];
    for (int c = 0; c < 3; ++c) {
      low[c] = std::nextafter(static_cast<float>(box.low[c]), -std::numeric_limits<float>::infinity());
      high[c] = std::nextafter(static_cast<float>(box.high[c]), std::numeric_limits<float>::infinity());
    }
    primitives.push_back(primitive_of(low, high, i));
  }
  return primitives;
}

RTCBounds bounds_of(const std::vector<RTCBuildPrimitive>& primitives) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  RTCBounds b{inf, inf, inf, 0.0f, -inf, -inf, -inf, 0.0f};
  for (const RTCBuildPrimitive& p : primitives) {
    b.lower_x = std::min(b.lower_x, p.lower_x);
    b.lower_y = std::min(b.lower_y, p.lower_y);
    b.lower_z = std::min(b.lower_z, p.lower_z);
    b.upper_x = std::max(b.upper_x, p.upper_x);
    b.upper_y = std::max(b.upper_y, p.upper_y);
    b.upper_z = std::max(b.upper_z, p.upper_z);
  }
  return b;
}

// Lays the tree out in depth-first order, so that a first child often lies behind its parent.
template <int W>
struct Layout {
  const Scene& scene;
  std::vector<BvhNode<W>> nodes;
  std::vector<TriangleBlock<W>> blocks;
  int depth = 0;

  uint add_leaf(const BuildNode* node) {
    const auto* leaf = static_cast<const BuildLeaf*>(node);
    if (leaf->quadric) {
      if (leaf->primitive[0] > LEAF_INDEX_MASK) throw Error(Exit::render_failed, "too many quadrics: expected at most 2^27");
      return LEAF_BIT | leaf->primitive[0];
    }
    const uint count = (leaf->count + W - 1) / W;
    const std::size_t first = blocks.size();
    if (first + count > LEAF_INDEX_MASK) throw Error(Exit::render_failed, "too many triangles: expected fewer than 2^27 leaf blocks");
    for (uint b = 0; b < count; ++b) {
      TriangleBlock<W>& block = blocks.emplace_back();
      for (int lane = 0; lane < W; ++lane) {
        // The last block is filled with copies of its last triangle: degenerate ones would not be rejected surely.
        const uint primitive = leaf->primitive[std::min<int>(b * W + lane, leaf->count - 1)];
        const packed_uint3 t = scene.triangles[primitive];
        const uint vertex[3] = {t.x, t.y, t.z};
        for (int v = 0; v < 3; ++v) {
          const packed_float3 p = scene.positions[vertex[v]];
          block.vertex[v][0][lane] = p.x;
          block.vertex[v][1][lane] = p.y;
          block.vertex[v][2][lane] = p.z;
        }
        block.primitive[lane] = primitive;
      }
    }
    return LEAF_BIT | count << LEAF_COUNT_SHIFT | static_cast<uint>(first);
  }

  // Recursion as deep as the tree: max_tree_depth at most.
  uint add(const BuildNode* node, int level) {
    if (node->leaf) return add_leaf(node);
    depth = std::max(depth, level);
    const std::size_t index = nodes.size();
    nodes.push_back(empty_node());
    for (int i = 0; i < node->count; ++i) {
      const uint child = add(node->child[i], level + 1);  // may move `nodes`
      BvhNode<W>& target = nodes[index];
      const RTCBounds& b = node->bounds[i];
      const float low[3] = {b.lower_x, b.lower_y, b.lower_z}, high[3] = {b.upper_x, b.upper_y, b.upper_z};
      for (int axis = 0; axis < 3; ++axis) {
        target.bounds[2 * axis][i] = low[axis] - box_padding;
        target.bounds[2 * axis + 1][i] = high[axis] + box_padding;
      }
      target.child[i] = child;
    }
    return static_cast<uint>(index);
  }

  static BvhNode<W> empty_node() {
    BvhNode<W> node{};
    for (int i = 0; i < W; ++i) {
      for (int row = 0; row < 6; ++row) node.bounds[row][i] = row % 2 == 0 ? 1e30f : -1e30f;
      node.child[i] = NONE;
    }
    return node;
  }
};

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

template <int W>
Bvh build(const Scene& scene) {
  std::optional<Builder> triangle_builder, quadric_builder;  // they own the trees until these are laid out
  BuildNode root;
  const auto attach = [&](BuildNode* tree, const RTCBounds& bounds) {
    root.bounds[root.count] = bounds;
    root.child[root.count++] = tree;
  };
  std::vector<RTCBuildPrimitive> primitives = triangle_primitives(scene);
  if (!primitives.empty()) {
    const RTCBounds bounds = bounds_of(primitives);
    attach(build_tree(triangle_builder.emplace(), primitives, W, false), bounds);
  }
  primitives = quadric_primitives(scene);
  if (!primitives.empty()) {
    const RTCBounds bounds = bounds_of(primitives);
    attach(build_tree(quadric_builder.emplace(), primitives, W, true), bounds);
  }
  Layout<W> layout{scene, {}, {}};
  const bool single = root.count == 1 && !root.child[0]->leaf;
  layout.add(single ? root.child[0] : &root, 1);
  Bvh bvh;
  bvh.width = W;
  bvh.node_count = layout.nodes.size();
  bvh.block_count = layout.blocks.size();
  bvh.depth = layout.depth;
  bvh.nodes = bytes_of(layout.nodes);
  bvh.blocks = bytes_of(layout.blocks);
  return bvh;
}

}  // namespace

int Bvh::stack_size() const {
  return static_cast<int>(std::bit_ceil(std::max(64u, static_cast<unsigned>((width - 1) * depth + 1))));
}

Bvh build_bvh(const Scene& scene, int width) {
  assert(width == 4 || width == 8);
  return width == 4 ? build<4>(scene) : build<8>(scene);
}

}  // namespace oclair
