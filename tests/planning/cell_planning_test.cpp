#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/planning/ompl/ompl_planning.h"

namespace tandem::planning {
namespace {

using Eigen::VectorXd;

/// The query "cross" of two real arms: both swing under a wall between them.
class CellPlanning : public testing::Test {
 protected:
  CellPlanning() {
    const auto& query = cell_->query("cross");
    problem_ = {VectorXd(cell_->dof()), VectorXd(cell_->dof()), cell_->lower(), cell_->upper()};
    for (std::size_t i = 0; i < cell_->arms().size(); ++i) {
      const world::Arm& arm = cell_->arms()[i];
      const auto values = [&](const std::optional<world::ArmGoal>& goal) {
        return std::get<world::JointGoal>(*goal).q;
      };
      problem_.start.segment(arm.offset, arm.dof()) = values(query.start[i]);
      problem_.goal.segment(arm.offset, arm.dof()) = values(query.goal[i]);
    }
  }
  motion::JointPath plan_and_simplify(Validity& validity, std::uint64_t seed) const {
    const auto stop = StopCondition::after(20);
    auto path = make_ompl_rrt_connect()->plan(problem_, validity, seed, stop).value();
    return make_ompl_simplifier()->simplify(problem_, std::move(path), validity, seed, stop);
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  collision::SsvChecker checker_{cell_};
  world::PairSelection all_ = cell_->select(world::PairScope::all());
  PathProblem problem_;
};

TEST_F(CellPlanning, CertifiedPathsAreFreeInDenseSamples) {
  ASSERT_FALSE(make_certified_validity(checker_, all_)->edge(problem_.start, problem_.goal));
  const auto scratch = checker_.make_scratch();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto validity = make_certified_validity(checker_, all_);
    const auto path = plan_and_simplify(*validity, seed);
    ASSERT_EQ(path.front(), problem_.start);
    ASSERT_EQ(path.back(), problem_.goal);
    for (std::size_t i = 1; i < path.size(); ++i) {
      EXPECT_TRUE(validity->edge(path[i - 1], path[i]));
      for (int k = 0; k <= 500; ++k) {
        const VectorXd q = path[i - 1] + k / 500.0 * (path[i] - path[i - 1]);
        ASSERT_TRUE(checker_.is_free(q, all_, *scratch)) << "seed " << seed << ", edge " << i;
      }
    }
    const ValidityStats& stats = validity->stats();
    std::printf("seed %d: %zu waypoints, %ld states and %ld edges checked in %.1f ms\n",
                static_cast<int>(seed), path.size(), stats.states, stats.edges,
                1e3 * stats.seconds);
  }
}

TEST_F(CellPlanning, EqualSeedsGiveEqualPathsWithEitherValidity) {
  const auto sampled =
      make_sampled_validity(checker_, all_, 1e-3 * l1_extent(problem_.lower, problem_.upper) / 2);
  const auto certified = make_certified_validity(checker_, all_);
  for (Validity* validity : {sampled.get(), certified.get()}) {
    const auto path = plan_and_simplify(*validity, 3);
    EXPECT_EQ(path, plan_and_simplify(*validity, 3));
    for (std::size_t i = 1; i < path.size(); ++i) {
      EXPECT_TRUE(validity->edge(path[i - 1], path[i])) << "edge " << i;
    }
  }
}

}  // namespace
}  // namespace tandem::planning
