#include "tandem/coordination/path_coordinator.h"

#include <gtest/gtest.h>

#include "conformance/coordination_cells.h"
#include "tandem/core/contract.h"
#include "tandem/planning/ompl/ompl_planning.h"
#include "tandem/planning/rrt_connect.h"
#include "tandem/planning/simplifier.h"

namespace tandem::coordination {
namespace {

using Eigen::VectorXd;

std::unique_ptr<Coordinator> make(bool ompl, const PathCoordinatorOptions& options = {}) {
  if (ompl) {
    return make_path_coordinator(std::shared_ptr(planning::make_ompl_rrt_connect()),
                                 std::shared_ptr(planning::make_ompl_simplifier()), options);
  }
  return make_path_coordinator(std::shared_ptr(planning::make_rrt_connect()),
                               std::shared_ptr(planning::make_simplifier()), options);
}

class OverPlanners : public testing::TestWithParam<bool> {
 protected:
  const std::unique_ptr<Coordinator> coordinator_ = make(GetParam());
};

/// Free at samples as near as it promises, and not faster than planned.
void expect_good(const test::CoordinationCase& c, const Schedule& schedule) {
  const VectorXd T = durations(c.problem());
  EXPECT_EQ(schedule.places.front(), VectorXd(VectorXd::Zero(T.size())));
  EXPECT_EQ(schedule.places.back(), T);
  const auto scratch = c.checker->make_scratch();
  const auto pairs = pairs_between_arms(c.checker->cell());
  VectorXd q(c.checker->cell().dof());
  for (std::size_t k = 1; k < schedule.places.size(); ++k) {
    const VectorXd &a = schedule.places[k - 1], &b = schedule.places[k];
    EXPECT_TRUE((b.array() >= 0).all() && (b.array() <= T.array()).all());
    EXPECT_NEAR((b - a).cwiseAbs().maxCoeff(), schedule.times[k] - schedule.times[k - 1], 1e-9);
    const PlacesEdge edge(c.arms, a, b);
    const int n = static_cast<int>(std::ceil((b - a).lpNorm<1>() / (1e-3 * T.sum())));
    for (int s = 0; s <= n; ++s) {
      edge.position(static_cast<double>(s) / n, q);
      EXPECT_TRUE(c.checker->is_free(q, pairs, *scratch)) << "edge " << k << " at " << s;
    }
  }
}

TEST_P(OverPlanners, FindsWaysThatWaitAndWaysThatGoBack) {
  for (const auto& c : {test::apart(), test::crossing(), test::siding(), test::back_and_forth(),
                        test::three_cross(), test::four_cross()}) {
    SCOPED_TRACE(c.name);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto schedule = coordinator_->coordinate(c.problem(), seed, StopCondition::after(20));
      ASSERT_TRUE(schedule) << schedule.error().message;
      expect_good(c, *schedule);
      bool goes_back = false;
      for (std::size_t k = 1; k < schedule->places.size(); ++k) {
        const VectorXd step = schedule->places[k] - schedule->places[k - 1];
        goes_back = goes_back || step.minCoeff() < -1e-3;
      }
      EXPECT_TRUE(goes_back || !c.goes_back);
    }
  }
}

TEST_P(OverPlanners, SearchesADeadlockUntilItIsStopped) {
  const auto c = test::head_on();
  const auto schedule = coordinator_->coordinate(c.problem(), 1, StopCondition::after(0.2));
  ASSERT_FALSE(schedule);
  EXPECT_EQ(schedule.error().code, ErrorCode::kTimeout);
  EXPECT_NE(schedule.error().message.find("coordinating"), std::string::npos)
      << schedule.error().message;
}

TEST_P(OverPlanners, EqualSeedsGiveEqualSchedules) {
  const auto c = test::siding();
  const auto a = coordinator_->coordinate(c.problem(), 5, StopCondition::after(20));
  const auto b = coordinator_->coordinate(c.problem(), 5, StopCondition::after(20));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->times, b->times);
  EXPECT_EQ(a->places, b->places);
}

TEST_P(OverPlanners, NamesWhatTouchesAtAnEndAndStopsWhenAsked) {
  const auto c = test::disc_case("start", {{{0, 0}, {1, 0}}, {{0.1, 0}, {0, 1}}});
  const auto touching = coordinator_->coordinate(c.problem(), 1, StopCondition::after(20));
  ASSERT_FALSE(touching);
  EXPECT_EQ(touching.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(touching.error().message.find("a/disc and b/disc"), std::string::npos);
  std::stop_source source;
  source.request_stop();
  const auto stopped = coordinator_->coordinate(test::crossing().problem(), 1,
                                                StopCondition::after(20, source.get_token()));
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

INSTANTIATE_TEST_SUITE_P(PathCoordinator, OverPlanners, testing::Bool(),
                         [](const auto& ompl) { return ompl.param ? "Ompl" : "Own"; });

TEST(PathCoordinator, RefusesWhatItCannotWorkWith) {
  EXPECT_THROW(make_path_coordinator(nullptr, std::shared_ptr(planning::make_simplifier())),
               ContractViolation);
  EXPECT_THROW(make(false, {.segment_fraction = 0}), ContractViolation);
}

}  // namespace
}  // namespace tandem::coordination
