#include "bvh.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "embree.h"
#include "error.h"
#include "parallel.h"

namespace oclair {
namespace {

constexpr int max_width = 8;
constexpr unsigned max_leaf_size = 32;
constexpr unsigned max_tree_depth = 1024;  // Embree's default of 32 fails on geometric progressions; real trees reach 200

// The tree as Embree's callbacks make it, in Embree's own arena; laid out afterwards and freed with it. A node knows what lies
// below it, so that its children can be laid out at the same time.
struct BuildNode {
  int count = 0;  // children; of a leaf: primitives
  bool leaf = false;
  bool quadric = false;
  uint node_count = 0;  // with itself
  uint block_count = 0;
  int depth = 0;        // nodes on the longest way down
};
struct BuildInner : BuildNode {
  RTCBounds bounds[max_width];
  BuildNode* child[max_width];

  // Once its children are whole.
  void count_below() {
    node_count = 1;
    depth = 1;
    for (int i = 0; i < count; ++i) {
      node_count += child[i]->node_count;
      block_count += child[i]->block_count;
      depth = std::max(depth, child[i]->depth + 1);
    }
  }
};
struct BuildLeaf : BuildNode {
  uint* primitives() { return reinterpret_cast<uint*>(this + 1); }  // as many as it has lie behind it
  const uint* primitives() const { return reinterpret_cast<const uint*>(this + 1); }
};

BuildLeaf* create_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count) {
  assert(count <= max_leaf_size);
  auto* leaf = new (rtcThreadLocalAlloc(arena, sizeof(BuildLeaf) + count * sizeof(uint), 16)) BuildLeaf;
  leaf->leaf = true;
  leaf->count = static_cast<int>(count);
  for (std::size_t i = 0; i < count; ++i) leaf->primitives()[i] = primitives[i].primID;
  return leaf;
}

void* create_triangle_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count, void* width) {
  BuildLeaf* leaf = create_leaf(arena, primitives, count);
  leaf->block_count = static_cast<uint>((count + *static_cast<int*>(width) - 1) / *static_cast<int*>(width));
  return static_cast<BuildNode*>(leaf);
}

void* create_quadric_leaf(RTCThreadLocalAllocator arena, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  BuildLeaf* leaf = create_leaf(arena, primitives, count);
  leaf->quadric = true;
  return static_cast<BuildNode*>(leaf);
}

void* create_node(RTCThreadLocalAllocator arena, unsigned count, void*) {
  auto* node = new (rtcThreadLocalAlloc(arena, sizeof(BuildInner), 16)) BuildInner;
  node->count = static_cast<int>(count);
  return static_cast<BuildNode*>(node);
}

BuildInner* inner(void* node) { return static_cast<BuildInner*>(static_cast<BuildNode*>(node)); }

// Called when all that is below the children stands.
void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) inner(node)->child[i] = static_cast<BuildNode*>(children[i]);
  inner(node)->count_below();
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) inner(node)->bounds[i] = *bounds[i];
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

using Primitives = BufferVector<RTCBuildPrimitive>;

BuildNode* build_tree(Builder& builder, Primitives& primitives, int width, bool quadrics) {
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
  arguments.userPtr = &width;
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

Primitives triangle_primitives(const Scene& scene) {
  Primitives primitives(scene.triangles.size());
  parallel_pieces(primitives.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const packed_uint3 t = scene.triangles[i];
      const packed_float3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
      const float low[3] = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
      const float high[3] = {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
      primitives[i] = primitive_of(low, high, i);
    }
  });
  return primitives;
}

Primitives quadric_primitives(const Scene& scene) {
  Primitives primitives;
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

template <class Box>
void include(RTCBounds& bounds, const Box& box) {
  bounds.lower_x = std::min(bounds.lower_x, box.lower_x);
  bounds.lower_y = std::min(bounds.lower_y, box.lower_y);
  bounds.lower_z = std::min(bounds.lower_z, box.lower_z);
  bounds.upper_x = std::max(bounds.upper_x, box.upper_x);
  bounds.upper_y = std::max(bounds.upper_y, box.upper_y);
  bounds.upper_z = std::max(bounds.upper_z, box.upper_z);
}

// Of a whole tree over the primitives.
RTCBounds bounds_of(const BuildNode* tree, const Primitives& primitives) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  RTCBounds bounds{inf, inf, inf, 0.0f, -inf, -inf, -inf, 0.0f};
  if (tree->leaf)
    for (const RTCBuildPrimitive& primitive : primitives) include(bounds, primitive);
  else
    for (int i = 0; i < tree->count; ++i) include(bounds, static_cast<const BuildInner*>(tree)->bounds[i]);
  return bounds;
}

// Lays the tree out in depth-first order, so that a first child often lies behind its parent.
template <int W>
struct Layout {
  const Scene& scene;
  BvhNode<W>* nodes;
  TriangleBlock<W>* blocks;

  // Blocks from `first` on.
  uint add_leaf(const BuildLeaf* leaf, uint first) const {
    if (leaf->quadric) return LEAF_BIT | leaf->primitives()[0];
    for (uint b = 0; b < leaf->block_count; ++b) {
      TriangleBlock<W>& block = blocks[first + b];
      for (int lane = 0; lane < W; ++lane) {
        // The last block is filled with copies of its last triangle: degenerate ones would not be rejected surely.
        const uint primitive = leaf->primitives()[std::min<int>(b * W + lane, leaf->count - 1)];
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
    return LEAF_BIT | leaf->block_count << LEAF_COUNT_SHIFT | first;
  }

  // The node at `index`, the nodes below it behind it, their blocks from `block` on. Recursion as deep as the tree:
  // max_tree_depth at most.
  void add(const BuildInner* node, uint index, uint block) const {
    constexpr uint LEAST_BLOCKS = 1024;  // that are worth a task of their own
    BvhNode<W>& target = nodes[index] = empty_node();
    tbb::task_group tasks;
    uint next = index + 1;
    for (int i = 0; i < node->count; ++i) {
      const BuildNode* child = node->child[i];
      const RTCBounds& b = node->bounds[i];
      const float low[3] = {b.lower_x, b.lower_y, b.lower_z}, high[3] = {b.upper_x, b.upper_y, b.upper_z};
      for (int axis = 0; axis < 3; ++axis) {
        target.bounds[2 * axis][i] = low[axis] - box_padding;
        target.bounds[2 * axis + 1][i] = high[axis] + box_padding;
      }
      target.child[i] = child->leaf ? add_leaf(static_cast<const BuildLeaf*>(child), block) : next;
      if (!child->leaf) {
        const auto below = [this, child, next, block] { add(static_cast<const BuildInner*>(child), next, block); };
        if (child->block_count < LEAST_BLOCKS) below();
        else tasks.run(below);
      }
      next += child->node_count;
      block += child->block_count;
    }
    tasks.wait();
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

template <int W>
Bvh build(const Scene& scene) {
  if (scene.quadrics.size() > LEAF_INDEX_MASK + 1u) throw Error(Exit::render_failed, "too many quadrics: expected at most 2^27");
  std::optional<Builder> triangle_builder, quadric_builder;  // they own the trees until these are laid out
  BuildInner above;
  const auto attach = [&](std::optional<Builder>& builder, Primitives primitives, bool quadrics) {
    if (primitives.empty()) return;
    above.child[above.count] = build_tree(builder.emplace(), primitives, W, quadrics);
    above.bounds[above.count] = bounds_of(above.child[above.count], primitives);
    ++above.count;
  };
  attach(triangle_builder, triangle_primitives(scene), false);
  attach(quadric_builder, quadric_primitives(scene), true);
  above.count_below();
  const bool single = above.count == 1 && !above.child[0]->leaf;
  const BuildInner& root = single ? static_cast<const BuildInner&>(*above.child[0]) : above;
  if (root.block_count > LEAF_INDEX_MASK)
    throw Error(Exit::render_failed, "too many triangles: expected fewer than 2^27 leaf blocks");
  Bvh bvh;
  bvh.width = W;
  bvh.node_count = root.node_count;
  bvh.block_count = root.block_count;
  bvh.depth = root.depth;
  bvh.nodes.resize(bvh.node_count * sizeof(BvhNode<W>));
  bvh.blocks.resize(bvh.block_count * sizeof(TriangleBlock<W>));
  wish_for_huge_pages(bvh.nodes.data(), bvh.nodes.size());
  wish_for_huge_pages(bvh.blocks.data(), bvh.blocks.size());
  Layout<W>{scene, reinterpret_cast<BvhNode<W>*>(bvh.nodes.data()), reinterpret_cast<TriangleBlock<W>*>(bvh.blocks.data())}
      .add(&root, 0, 0);
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
