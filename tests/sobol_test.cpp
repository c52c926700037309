// Nets and their scrambling, exhaustively.
#include <array>
#include <set>

#include "extremes.h"
#include "kernel.h"
#include "random.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr int m = REPLICA_BITS;
constexpr cl_uint n = REPLICA_SAMPLES;

using Point = std::array<cl_uint, 2>;  // m digits of each coordinate, the first one highest

// The points of every net, one after the other.
std::vector<Point> nets(const std::vector<cl_ulong>& choices) {
  std::vector<cl_uint> index;
  std::vector<cl_ulong> trees;
  for (const cl_ulong choice : choices)
    for (cl_uint i = 0; i < n; ++i) index.push_back(i), trees.push_back(choice);
  std::vector<Point> points(index.size());
  run("sobol_test.cl", "points", index.size(), index, trees, out(points));
  return points;
}

std::vector<cl_ulong> random_trees(std::size_t count) {
  Random random(1);
  std::vector<cl_ulong> trees(count);
  for (cl_ulong& tree : trees) tree = random.engine();
  return trees;
}

}  // namespace

// Sobol's second dimension belongs to the primitive polynomial x + 1: direction numbers m_k = 2 m_(k-1) xor m_(k-1), m_1 = 1
// (Bratley and Fox 1988; Joe and Kuo 2008). The first one is van der Corput's sequence, m_k = 1.
TEST(sobol_test, unscrambled_points_are_those_of_the_direction_numbers) {
  const std::vector<Point> points = nets({0});
  for (cl_uint i = 0; i < n; ++i) {
    Point expected{};
    cl_uint direction = 1;
    for (int k = 1; k <= m; ++k) {
      if (i >> (k - 1) & 1) expected[0] ^= 1u << (m - k), expected[1] ^= direction << (m - k);
      direction ^= direction << 1;
    }
    EXPECT_EQ(points[i], expected) << i;
  }
}

// Entry (row, column) of Pascal's triangle modulo 2, highest digit first: binomial(column, row), by addition.
TEST(sobol_test, second_coordinate_is_pascals_triangle_times_the_first) {
  int pascal[m][m] = {};
  for (int column = 0; column < m; ++column)
    for (int row = 0; row <= column; ++row)
      pascal[row][column] = row == 0 ? 1 : (pascal[row - 1][column - 1] + (row < column ? pascal[row][column - 1] : 0)) % 2;
  std::vector<cl_uint> digits(n), found(n);
  for (cl_uint i = 0; i < n; ++i) digits[i] = i;
  run("sobol_test.cl", "second", n, digits, out(found));
  for (cl_uint i = 0; i < n; ++i) {
    cl_uint expected = 0;
    for (int row = 0; row < m; ++row) {
      int digit = 0;
      for (int column = 0; column < m; ++column) digit ^= pascal[row][column] & static_cast<int>(i >> (m - 1 - column) & 1);
      expected |= static_cast<cl_uint>(digit) << (m - 1 - row);
    }
    EXPECT_EQ(found[i], expected) << i;
  }
}

// Every elementary interval of area 2^-k holds one of every 2^k points from a multiple of 2^k on, for every k: so is a part
// of a replica.
TEST(sobol_test, every_elementary_interval_holds_one_point_of_every_aligned_block) {
  const std::vector<Point> points = nets(random_trees(count_or_small(20000, 5)));
  for (int k = 0; k <= m; ++k)
    for (std::size_t first = 0; first < points.size(); first += std::size_t{1} << k)
      for (int across = 0; across <= k; ++across) {
        std::set<cl_uint> cells;
        for (std::size_t i = first; i < first + (std::size_t{1} << k); ++i) {
          const auto [x, y] = points[i];
          ASSERT_LT(std::max(x, y), n);
          cells.insert((x >> (m - across)) << (k - across) | y >> (m - k + across));
        }
        ASSERT_EQ(cells.size(), std::size_t{1} << k) << "net " << first / n << ", " << (1 << across) << " columns";
      }
  record_law("X23");
}

// All trees on all digits. A scrambling is Owen's if digits that agree up to one agree up to that one afterwards, and as
// there are as many such permutations as trees, each comes with equal probability if no two trees have the same one.
TEST(sobol_test, trees_are_all_of_owens_permutations_once_each) {
  const cl_uint trees = static_cast<cl_uint>(count_or_small(std::size_t{1} << (n - 1), 64));
  std::vector<cl_uint> digits, tree;
  for (cl_uint t = 0; t < trees; ++t)
    for (cl_uint d = 0; d < n; ++d) digits.push_back(d), tree.push_back(t << 1 | (t & 1));  // bit 0 is not read
  std::vector<cl_uint> result(digits.size());
  run("sobol_test.cl", "scramble", digits.size(), digits, tree, out(result));
  std::set<std::vector<cl_uint>> permutations;
  for (cl_uint t = 0; t < trees; ++t) {
    const std::vector<cl_uint> permutation(&result[t * n], &result[t * n] + n);
    permutations.insert(permutation);
    for (cl_uint a = 0; a < n; ++a)
      for (cl_uint b = 0; b < a; ++b)
        for (int level = 0; level <= m; ++level)
          ASSERT_EQ(a >> (m - level) == b >> (m - level), permutation[a] >> (m - level) == permutation[b] >> (m - level));
  }
  EXPECT_EQ(permutations.size(), trees);
}

// All digits under all trees, by the definition: the digit at each level is flipped by the bit of the node that the digits before it lead to.
TEST(sobol_test, order_is_owens_scrambling_read_backwards) {
  const cl_uint trees = static_cast<cl_uint>(count_or_small(std::size_t{1} << n, 64));
  std::vector<cl_uint> digits, tree, expected;
  for (cl_uint t = 0; t < trees; ++t)
    for (cl_uint d = 0; d < n; ++d) {
      cl_uint node = 1, reversed = 0;
      for (int level = 0; level < m; ++level) {
        const cl_uint digit = d >> (m - 1 - level) & 1;
        reversed += (digit ^ (t >> node & 1)) << level;
        node = 2 * node + digit;
      }
      digits.push_back(d), tree.push_back(t), expected.push_back(reversed);
    }
  std::vector<cl_uint> result(digits.size());
  run("sobol_test.cl", "scramble_and_reverse", digits.size(), digits, tree, out(result));
  EXPECT_TRUE(result == expected);
}

// 16 bits each. The order's changes no point of the net, a coordinate's not the other coordinate.
TEST(sobol_test, order_and_coordinates_have_trees_of_their_own) {
  const cl_ulong word = 0x123456789abcu;
  const std::vector<Point> plain = nets({word});
  for (int tree = 0; tree < 3; ++tree) {
    const std::vector<Point> changed = nets({word ^ cl_ulong{2} << tree * n});  // flips the first digit
    if (tree == 0) {
      EXPECT_NE(changed, plain);
      EXPECT_EQ(std::set<Point>(changed.begin(), changed.end()), std::set<Point>(plain.begin(), plain.end()));
      continue;
    }
    for (cl_uint i = 0; i < n; ++i) {
      EXPECT_EQ(changed[i][tree - 1], plain[i][tree - 1] ^ n / 2);
      EXPECT_EQ(changed[i][2 - tree], plain[i][2 - tree]);
    }
  }
}
