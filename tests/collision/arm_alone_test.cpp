// Checkers on the cell of one arm answer as on the whole cell about that arm.

#include <gtest/gtest.h>

#include "collision/random_cell.h"
#include "tandem/collision/batch_checker.h"

namespace tandem::collision {
namespace {

using Eigen::VectorXd;

struct Both {
  explicit Both(std::shared_ptr<const world::Workcell> workcell)
      : cell(std::move(workcell)), exact(cell), batch(exact), scratch(exact.make_scratch()) {}
  std::shared_ptr<const world::Workcell> cell;
  SsvChecker exact;
  BatchChecker batch;
  std::unique_ptr<CollisionChecker::Scratch> scratch;
};

class ArmAlone : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ArmAlone, VerdictsAndClearancesAreThoseOfTheWholeCell) {
  const Both whole(test::random_cell(GetParam(), {.arms = 3, .surface_pieces = 12}));
  Rng rng(GetParam() + 100);
  int free = 0, touching = 0;
  for (int i = 0; i < 3; ++i) {
    const Both alone(whole.cell->arm_alone(i));
    const world::Arm& arm = whole.cell->arms()[static_cast<std::size_t>(i)];
    const world::PairSelection of_whole = whole.cell->select(world::PairScope::arm(i));
    const world::PairSelection of_alone = alone.cell->select(world::PairScope::all());
    const auto whole_pairs = whole.batch.compile(of_whole),
               own_pairs = alone.batch.compile(of_alone);
    const auto whole_batch = whole.batch.make_scratch(), own_batch = alone.batch.make_scratch();
    VectorXd before;
    for (int k = 0; k < 150; ++k) {
      const VectorXd q = test::random_configuration(rng, *whole.cell);
      const VectorXd own = q.segment(arm.offset, arm.dof());
      const bool verdict = whole.exact.is_free(q, of_whole, *whole.scratch);
      ++(verdict ? free : touching);
      EXPECT_EQ(alone.exact.is_free(own, of_alone, *alone.scratch), verdict);
      EXPECT_EQ(alone.batch.are_free(own, *own_pairs, *own_batch), verdict);
      const PairClearance a = whole.exact.least_clearance(q, of_whole, *whole.scratch);
      const PairClearance b = alone.exact.least_clearance(own, of_alone, *alone.scratch);
      EXPECT_EQ(a.distance, b.distance);
      EXPECT_EQ(whole.cell->describe_pair(a.pair), alone.cell->describe_pair(b.pair));
      if (k > 0) {
        VectorXd from = q;
        from.segment(arm.offset, arm.dof()) = before;
        EXPECT_EQ(whole.batch.is_edge_free(from, q, *whole_pairs, *whole_batch),
                  alone.batch.is_edge_free(before, own, *own_pairs, *own_batch));
      }
      before = own;
    }
  }
  EXPECT_GT(free, 10);
  EXPECT_GT(touching, 10);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ArmAlone, ::testing::Range<std::uint64_t>(1, 9));

}  // namespace
}  // namespace tandem::collision
