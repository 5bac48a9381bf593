#include "tandem/pipeline/plan.h"

#include <gtest/gtest.h>

#include <thread>

#include "small_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/pipeline/planner.h"
#include "tandem/trajectory/limit_check.h"

namespace tandem::pipeline {
namespace {

class PlanOnSmallCell : public ::testing::Test {
 protected:
  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  const world::Query& query_ = cell_->query("cross");
};

TEST_F(PlanOnSmallCell, ReturnsAProvenMotionFromStartToGoal) {
  const collision::SsvChecker checker(cell_);
  const auto scratch = checker.make_scratch();
  const auto all = cell_->select(world::PairScope::all());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PlanOptions options;
    options.seed = seed;
    const auto planned = plan(cell_, query_, options);
    ASSERT_TRUE(planned) << planned.error().message;
    const auto& motion = planned->trajectory;
    const motion::JointState start = motion.at(0), goal = motion.at(motion.duration());
    EXPECT_LT((start.q - planned->ends.start).norm(), 1e-9);
    EXPECT_LT((goal.q - planned->ends.goal).norm(), 1e-9);
    EXPECT_LT(start.qd.norm() + start.qdd.norm() + goal.qd.norm() + goal.qdd.norm(), 1e-6);
    for (std::size_t i = 0; i < motion.arms().size(); ++i) {
      const std::vector limits(cell_->limits().begin() + cell_->arms()[i].offset,
                               cell_->limits().begin() + cell_->arms()[i].offset + 4);
      EXPECT_TRUE(trajectory::check_limits(motion.arms()[i], limits).empty());
      EXPECT_LT(motion.arms()[i].largest_jumps().maxCoeff(), 1e-6);
    }
    // Dense samples, independent of the certificate.
    Eigen::VectorXd q(cell_->dof());
    for (int k = 0; k <= 2000; ++k) {
      motion.position(motion.duration() * k / 2000, q);
      EXPECT_GE(checker.least_clearance(q, all, *scratch).distance,
                planned->report.least_clearance - 1e-9);
    }
    EXPECT_GT(planned->report.least_clearance, 0);
    EXPECT_GT(planned->report.counts.edge_checks, 0);
    EXPECT_GT(planned->report.times.path_planning, 0);
    std::vector<std::string> phases;
    for (const Phase& phase : planned->report.phases) phases.push_back(phase.name);
    EXPECT_EQ(phases, (std::vector<std::string>{"planned", "simplified", "interpolated",
                                                "shortened", "simplified_again"}));
  }
}

TEST_F(PlanOnSmallCell, OnePlannerMakesThePlansOfMany) {
  const Planner planner(cell_);
  std::vector<std::jthread> threads;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    threads.emplace_back([&, seed] {
      const auto alone = plan(cell_, query_, {.seed = seed});
      const auto shared = planner.plan(query_, {.seed = seed});
      ASSERT_TRUE(alone && shared);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(alone->trajectory.arms()[i].spline().knots(),
                  shared->trajectory.arms()[i].spline().knots());
        EXPECT_EQ(alone->trajectory.arms()[i].spline().segments(),
                  shared->trajectory.arms()[i].spline().segments());
      }
    });
  }
}

TEST_F(PlanOnSmallCell, PlannersCompileEveryCellOnce) {
  const Planner planner(cell_);
  const auto compiled = planner.compiled();
  EXPECT_EQ(planner.compiled(cell_), compiled);
  EXPECT_EQ(compiled->shared_cell(), cell_);
  const auto all = world::PairScope::all();
  EXPECT_EQ(compiled->pairs(all), compiled->pairs(all));
  EXPECT_NE(compiled->pairs(all), compiled->pairs(world::PairScope::several()));
  // As many cells as there may be: none is forgotten that is still in use.
  for (int i = 0; i < 100; ++i) {
    const std::shared_ptr<const world::Workcell> other = test::small_cell();
    EXPECT_EQ(planner.compiled(other)->shared_cell(), other);
    EXPECT_EQ(planner.compiled(), compiled);
  }
}

TEST_F(PlanOnSmallCell, SameSeedSamePlanOtherSeedOtherPlan) {
  const auto a = plan(cell_, query_, {.seed = 5}), b = plan(cell_, query_, {.seed = 5}),
             c = plan(cell_, query_, {.seed = 6});
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(a->trajectory.arms()[0].spline().knots(), b->trajectory.arms()[0].spline().knots());
  EXPECT_NE(a->trajectory.arms()[0].spline().knots(), c->trajectory.arms()[0].spline().knots());
}

TEST_F(PlanOnSmallCell, PaperPresetRepairsNothing) {
  int failures = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PlanOptions options;
    options.preset = Preset::kPaper;
    options.seed = seed;
    const auto planned = plan(cell_, query_, options);
    if (planned) {
      EXPECT_TRUE(planned->report.rungs.empty());
    } else {
      ++failures;
      EXPECT_TRUE(planned.error().code == ErrorCode::kCollision ||
                  planned.error().code == ErrorCode::kLimits)
          << planned.error().message;
    }
  }
  std::printf("paper preset: %d of 20 executed curves fail\n", failures);
}

TEST_F(PlanOnSmallCell, DeadlineAndStopAreErrorsOfTheirOwn) {
  PlanOptions late;
  late.deadline = 1e-6;
  const auto timed_out = plan(cell_, query_, late);
  ASSERT_FALSE(timed_out);
  EXPECT_EQ(timed_out.error().code, ErrorCode::kTimeout);

  std::stop_source source;
  source.request_stop();
  PlanOptions stopped;
  stopped.token = source.get_token();
  const auto cancelled = plan(cell_, query_, stopped);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

TEST_F(PlanOnSmallCell, InfeasibleGoalIsFoundBeforePlanning) {
  auto ends = *resolve(cell_, query_);
  ends.goal[1] = 1.0;
  PlanReport report;
  const auto planned = plan(cell_, ends, {}, &report);
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
  EXPECT_EQ(report.times.path_planning, 0);
}

TEST_F(PlanOnSmallCell, StandingStillIsAMotion) {
  auto ends = *resolve(cell_, query_);
  ends.goal = ends.start;
  const auto planned = plan(cell_, ends);
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_GT(planned->trajectory.duration(), 0);
  EXPECT_EQ(planned->trajectory.at(0.001).q, ends.start);
}

}  // namespace
}  // namespace tandem::pipeline
