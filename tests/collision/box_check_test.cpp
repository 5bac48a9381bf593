#include "tandem/collision/box_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "collision/batch_targets.h"
#include "collision/random_cell.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Eigen::VectorXd;
using world::PairScope;

struct BoxCase {
  const char* name;
  int surface_pieces;
};

void PrintTo(const BoxCase& c, std::ostream* out) { *out << c.name; }

class BoxCheck : public testing::TestWithParam<BoxCase> {
 protected:
  test::RandomCellOptions options() const {
    test::RandomCellOptions options{.joints = 4, .obstacles = 2};
    options.surface_pieces = GetParam().surface_pieces;
    return options;
  }
};

/// A corner of the box, or a point inside.
VectorXd sample(Rng& rng, const VectorXd& center, const VectorXd& D) {
  VectorXd q = center;
  const bool corner = rng.index(2) == 0;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    q[j] += D[j] * (corner ? (rng.index(2) == 0 ? 1.0 : -1.0) : rng.uniform(-1, 1));
  }
  return q;
}

TEST_P(BoxCheck, HoldsInEverySample) {
  int free = 0, touching = 0, open = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto cell = test::random_cell(seed, options());
    const SsvChecker checker(cell);
    const auto scratch = checker.make_scratch(), sampled = checker.make_scratch();
    Rng rng(seed);
    for (int n = 0; n < 150; ++n) {
      const auto pairs =
          cell->select(rng.index(2) == 0 ? PairScope::all() : PairScope::between(0, 1));
      const VectorXd center = test::random_configuration(rng, *cell, 0.9);
      const double size = std::pow(10.0, rng.uniform(-3, -0.2));
      VectorXd D(center.size());
      for (double& d : D) d = rng.index(3) == 0 ? 0.0 : rng.uniform(0, size);
      std::vector<int> unproven{-7};
      const BoxFinding found = examine_box(checker, center, D, pairs, *scratch, unproven);
      EXPECT_EQ(unproven.front(), -7) << "appends";
      unproven.erase(unproven.begin());
      (found.verdict == BoxVerdict::kFree   ? free
       : found.verdict == BoxVerdict::kOpen ? open
                                            : touching)++;
      EXPECT_EQ(found.verdict == BoxVerdict::kOpen, !unproven.empty());
      std::vector<int> apart;
      for (int pair : pairs) {
        if (std::ranges::find(unproven, pair) == unproven.end()) apart.push_back(pair);
      }
      EXPECT_TRUE(unproven.empty() || found.pair == unproven.front());
      if (found.touches_at_center) {
        EXPECT_FALSE(checker.is_free(center, {found.pair}, *sampled));
      } else {
        EXPECT_TRUE(checker.is_free(center, pairs, *sampled));
      }
      for (int k = 0; k < 60; ++k) {
        const VectorXd q = sample(rng, center, D);
        if (found.verdict == BoxVerdict::kTouching) {
          ASSERT_FALSE(checker.is_free(q, {found.pair}, *sampled)) << "seed " << seed;
        } else {
          ASSERT_TRUE(checker.is_free(q, apart, *sampled)) << "seed " << seed;
        }
      }
    }
  }
  std::printf("%d free, %d touching, %d open\n", free, touching, open);
  EXPECT_GT(free, 200);
  EXPECT_GT(touching, 200);
  EXPECT_GT(open, 100);
}

TEST_P(BoxCheck, PointsAreDecided) {
  int free = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto cell = test::random_cell(seed, options());
    const SsvChecker checker(cell);
    const auto scratch = checker.make_scratch();
    Rng rng(seed);
    const VectorXd zero = VectorXd::Zero(cell->dof());
    for (int n = 0; n < 100; ++n) {
      const auto pairs = cell->select(n % 2 == 0 ? PairScope::all() : PairScope::between(0, 1));
      const VectorXd q = test::random_configuration(rng, *cell);
      std::vector<int> unproven;
      const BoxFinding found = examine_box(checker, q, zero, pairs, *scratch, unproven);
      const bool is_free = checker.is_free(q, pairs, *scratch);
      EXPECT_EQ(found.verdict == BoxVerdict::kFree, is_free);
      // Surfaces have no depth in what they enclose, so that such boxes stay open.
      if (GetParam().surface_pieces == 0) {
        EXPECT_EQ(found.verdict == BoxVerdict::kTouching, !is_free);
      }
      free += is_free;
    }
  }
  EXPECT_GT(free, 200);
  EXPECT_LT(free, 1100);
}

/// Up to as many boxes as are examined in one go.
struct Boxes {
  Eigen::MatrixXd Q, D;
};

Boxes random_boxes(Rng& rng, const world::Workcell& cell) {
  const auto count =
      static_cast<Eigen::Index>(rng.index(static_cast<std::size_t>(boxes_at_once()) + 1));
  Boxes boxes{Eigen::MatrixXd(cell.dof(), count), Eigen::MatrixXd(cell.dof(), count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    boxes.Q.col(i) = test::random_configuration(rng, cell, 0.9);
    const double size = std::pow(10.0, rng.uniform(-3, -0.2));
    for (double& d : boxes.D.col(i)) d = rng.index(3) == 0 ? 0.0 : rng.uniform(0, size);
  }
  return boxes;
}

struct BatchTally {
  int free = 0, touching = 0, exactly_free = 0, exactly_touching = 0, boxes = 0;
};

/// Whether a verdict of the batch holds in samples; counts it beside that of the single box.
void check_finding(const SsvChecker& checker, const world::PairSelection& pairs, const VectorXd& q,
                   const VectorXd& D, const BoxFinding& found, Rng& rng,
                   CollisionChecker::Scratch& scratch, BatchTally& tally) {
  std::vector<int> unproven;
  const BoxFinding exact = examine_box(checker, q, D, pairs, scratch, unproven);
  ++tally.boxes;
  tally.exactly_free += exact.verdict == BoxVerdict::kFree;
  tally.exactly_touching += exact.verdict == BoxVerdict::kTouching;
  tally.free += found.verdict == BoxVerdict::kFree;
  tally.touching += found.verdict == BoxVerdict::kTouching;
  if (found.verdict == BoxVerdict::kFree) {
    EXPECT_EQ(found.pair, -1);
  } else {
    const auto& pair = checker.cell().pairs()[static_cast<std::size_t>(found.pair)];
    EXPECT_TRUE(std::ranges::find(pairs, found.pair) != pairs.end());
    EXPECT_TRUE(found.mover == pair.a || found.mover == pair.b);
  }
  if (found.touches_at_center) {
    EXPECT_FALSE(checker.is_free(q, {found.pair}, scratch));
  }
  if (found.verdict == BoxVerdict::kOpen) return;
  for (int k = 0; k < 30; ++k) {
    const VectorXd p =
        sample(rng, q, D).cwiseMax(checker.cell().lower()).cwiseMin(checker.cell().upper());
    if (found.verdict == BoxVerdict::kTouching) {
      ASSERT_FALSE(checker.is_free(p, {found.pair}, scratch));
    } else {
      ASSERT_TRUE(checker.is_free(p, pairs, scratch));
    }
  }
}

TEST_P(BoxCheck, BatchesHoldInEverySample) {
  test::for_each_target([&] {
    BatchTally tally;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const auto cell = test::random_cell(seed, options());
      const SsvChecker checker(cell);
      const BatchChecker batch(checker);
      const auto scratch = batch.make_scratch();
      const auto exact = checker.make_scratch();
      Rng rng(seed);
      for (int n = 0; n < 320 / boxes_at_once(); ++n) {
        const auto pairs = cell->select(n % 2 == 0 ? PairScope::all() : PairScope::between(0, 1));
        const auto compiled = batch.compile(pairs);
        const Boxes boxes = random_boxes(rng, *cell);
        std::vector<BoxFinding> found;
        std::vector<int> open;
        examine_boxes(batch, boxes.Q, boxes.D, *compiled, {}, *scratch, found, open);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(boxes.Q.cols()));
        for (Eigen::Index i = 0; i < boxes.Q.cols(); ++i) {
          check_finding(checker, pairs, boxes.Q.col(i), boxes.D.col(i),
                        found[static_cast<std::size_t>(i)], rng, *exact, tally);
        }
        if (open.empty()) continue;
        // Smaller boxes inside of these need not be asked about the rest.
        Boxes inner = boxes;
        for (Eigen::Index i = 0; i < boxes.Q.cols(); ++i) {
          inner.D.col(i) *= 0.3;
          inner.Q.col(i) = sample(rng, boxes.Q.col(i), boxes.D.col(i) - inner.D.col(i))
                               .cwiseMax(cell->lower())
                               .cwiseMin(cell->upper());
        }
        const std::vector<int> items = open;
        examine_boxes(batch, inner.Q, inner.D, *compiled, items, *scratch, found, open);
        for (Eigen::Index i = 0; i < boxes.Q.cols(); ++i) {
          check_finding(checker, pairs, inner.Q.col(i), inner.D.col(i),
                        found[static_cast<std::size_t>(i)], rng, *exact, tally);
        }
        EXPECT_TRUE(std::ranges::includes(std::set(items.begin(), items.end()),
                                          std::set(open.begin(), open.end())));
      }
    }
    std::printf("of %d boxes %d free (singly %d), %d touch (singly %d)\n", tally.boxes, tally.free,
                tally.exactly_free, tally.touching, tally.exactly_touching);
    EXPECT_GT(tally.free, tally.exactly_free * 7 / 10);
    EXPECT_GT(tally.touching, tally.exactly_touching / 2);
    EXPECT_GT(tally.touching, 100);
  });
}

INSTANTIATE_TEST_SUITE_P(Cells, BoxCheck,
                         testing::Values(BoxCase{"shapes", 0}, BoxCase{"surfaces", 60}),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace tandem::collision
