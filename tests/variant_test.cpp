// How many kernels a user ever compiles: counted, because compilation cannot be timed in a test.
#include "../host/variant.h"

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <set>

#include "../host/bvh.h"
#include "../host/upload.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr Features alone = FEATURE_MOMENTS | FEATURE_SOBOL;  // what only those who ask for it get
constexpr Variant variants[] = {Variant::PLAIN, Variant::SURFACES, Variant::TEXTURED, Variant::FULL};

// Few features, or many.
std::vector<Features> random_scenes() {
  std::mt19937_64 random(1);
  std::vector<Features> scenes{0};
  for (int i = 0; i < 30000; ++i) {
    Features scene = random() & ALL_FEATURES;
    for (int thinned = i % 6; thinned > 0; --thinned) scene &= random();
    scenes.push_back(scene & ~alone);
  }
  for (int bit = 0; bit < 64; ++bit) scenes.push_back(ALL_FEATURES & ~alone & Features{1} << bit);
  return scenes;
}

Features shared(Features scene) { return variant_features(variant_of(scene), scene); }

}  // namespace

TEST(variant_test, all_scenes_share_four_kernels) {
  std::set<Features> kernels;
  for (Features scene : random_scenes()) kernels.insert(shared(scene));
  EXPECT_EQ(kernels.size(), 4u);
}

TEST(variant_test, a_scene_gets_the_smallest_kernel_that_holds_its_features) {
  for (Features scene : random_scenes()) {
    EXPECT_EQ(scene & ~shared(scene), 0u) << scene;
    for (int smaller = 0; smaller < static_cast<int>(variant_of(scene)); ++smaller)
      EXPECT_NE(scene & ~variant_features(variants[smaller], 0), 0u) << scene;
  }
}

TEST(variant_test, a_variant_holds_all_that_the_one_before_it_holds_and_the_last_one_everything) {
  for (int i = 1; i < 4; ++i) {
    const Features before = variant_features(variants[i - 1], 0), features = variant_features(variants[i], 0);
    EXPECT_EQ(before & ~features, 0u);
    EXPECT_GT(std::popcount(features), std::popcount(before));
  }
  EXPECT_EQ(variant_features(Variant::FULL, 0), ALL_FEATURES & ~alone);
}

TEST(variant_test, what_stands_alone_is_compiled_only_for_those_who_ask) {
  EXPECT_EQ(shared(FEATURE_DIFFUSE) & alone, 0u);
  EXPECT_EQ(shared(alone), shared(0) | alone);
}

TEST(variant_test, the_program_that_renders_is_one_kernel) {
  const cl::Program program = build_program(device(), kernel_directory() / "path.cl", {shared(0)});
  EXPECT_EQ(program.getInfo<CL_PROGRAM_NUM_KERNELS>(), 1u);
}

// The depth of the tree is compiled in as the size of its stack: a power of two, and up to the depths of real trees the same one.
TEST(variant_test, trees_of_usual_depth_share_one_stack_size) {
  std::set<int> sizes;
  for (unsigned depth = 1; depth <= 1000; ++depth) {
    Bvh bvh;
    bvh.width = 8;
    bvh.depth = depth;
    EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(bvh.stack_size())));
    EXPECT_GE(bvh.stack_size(), 7 * static_cast<int>(depth) + 1);
    sizes.insert(bvh.stack_size());
    EXPECT_TRUE(depth > 9 || sizes == std::set{64}) << depth;
  }
  EXPECT_LE(sizes.size(), 8u);
}
