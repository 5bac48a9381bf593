#include "tandem/core/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace tandem {
namespace {

TEST(Rng, RepeatsItselfForOneSeedAndDiffersForNeighbours) {
  Rng a(5), b(5);
  std::set<double> firsts;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(a.uniform(), b.uniform());
    firsts.insert(Rng(static_cast<std::uint64_t>(i)).uniform());
  }
  EXPECT_EQ(firsts.size(), 1000u);
}

TEST(Rng, UniformStaysInItsRangeAndFillsIt) {
  Rng rng(1);
  constexpr int kDraws = 100000;
  std::array<int, 10> histogram{};
  for (int i = 0; i < kDraws; ++i) {
    const double x = rng.uniform(-2, 3);
    ASSERT_GE(x, -2);
    ASSERT_LT(x, 3);
    ++histogram[static_cast<std::size_t>((x + 2) * 2)];
  }
  // Six standard deviations of a bin.
  for (int count : histogram) EXPECT_NEAR(count, kDraws / 10, 6 * std::sqrt(kDraws * 0.09));
}

TEST(Rng, IndexReachesEveryValueAndNoOther) {
  Rng rng(2);
  std::set<std::size_t> seen;
  for (int i = 0; i < 1000; ++i) seen.insert(rng.index(7));
  EXPECT_EQ(seen.size(), 7u);
  EXPECT_EQ(*seen.rbegin(), 6u);
  EXPECT_EQ(rng.index(1), 0u);
}

TEST(Rng, SplitsIntoGeneratorsThatDiffer) {
  Rng parent(3);
  Rng a(parent.split()), b(parent.split());
  int equal = 0;
  for (int i = 0; i < 100; ++i) equal += a.index(1000) == b.index(1000);
  EXPECT_LT(equal, 5);
}

}  // namespace
}  // namespace tandem
