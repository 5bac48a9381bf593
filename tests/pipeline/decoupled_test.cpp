#include "tandem/pipeline/decoupled.h"

#include <gtest/gtest.h>

#include <cmath>

#include "small_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/pipeline/planner.h"

namespace tandem::pipeline {
namespace {

using Eigen::VectorXd;

class DecoupledOnSmallCell : public ::testing::Test {
 protected:
  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  Planner planner_{cell_};
  const world::Query& query_ = cell_->query("cross");
};

TEST_F(DecoupledOnSmallCell, ReturnsAProvenMotionFromStartToGoal) {
  const collision::SsvChecker checker(cell_);
  const auto scratch = checker.make_scratch();
  const auto all = cell_->select(world::PairScope::all());
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const Strategy strategy : {Strategy::kDecoupled, Strategy::kAuto}) {
      const auto planned =
          planner_.plan(query_, {.strategy = strategy, .seed = seed, .deadline = 60});
      ASSERT_TRUE(planned) << planned.error().message;
      EXPECT_EQ(planned->strategy, strategy);
      const motion::CellMotion& motion = planned->trajectory;
      const motion::JointState start = motion.at(0), goal = motion.at(motion.duration());
      EXPECT_LT((start.q - planned->ends.start).norm(), 1e-9);
      EXPECT_LT((goal.q - planned->ends.goal).norm(), 1e-9);
      EXPECT_LT(start.qd.norm() + goal.qd.norm() + start.qdd.norm() + goal.qdd.norm(), 1e-6);
      // Dense samples, independent of certificate and limit check.
      for (int k = 0; k <= 500; ++k) {
        const motion::JointState state = motion.at(motion.duration() * k / 500);
        EXPECT_GE(checker.least_clearance(state.q, all, *scratch).distance,
                  planned->report.least_clearance - 1e-9);
        for (Eigen::Index j = 0; j < state.q.size(); ++j) {
          const robot::JointLimits& limits = cell_->limits()[static_cast<std::size_t>(j)];
          EXPECT_LE(std::abs(state.qd[j]), limits.velocity * (1 + 1e-6));
          EXPECT_LE(std::abs(state.qdd[j]), limits.acceleration * (1 + 1e-6));
        }
      }
      EXPECT_GT(planned->report.least_clearance, 0);
    }
  }
}

TEST_F(DecoupledOnSmallCell, SameSeedSamePlanOtherSeedOtherPlan) {
  const auto plan_with = [&](std::uint64_t seed) {
    return planner_.plan(query_, {.strategy = Strategy::kDecoupled, .seed = seed, .deadline = 60});
  };
  const auto a = plan_with(5), b = plan_with(5), c = plan_with(6);
  ASSERT_TRUE(a && b && c);
  VectorXd of_a(cell_->dof()), of_b(cell_->dof()), of_c(cell_->dof());
  EXPECT_EQ(a->trajectory.duration(), b->trajectory.duration());
  bool differs = false;
  for (int k = 0; k <= 20; ++k) {
    const double t = a->trajectory.duration() * k / 20;
    a->trajectory.position(t, of_a);
    b->trajectory.position(t, of_b);
    c->trajectory.position(t, of_c);
    EXPECT_EQ(of_a, of_b);
    differs = differs || of_a != of_c;
  }
  EXPECT_TRUE(differs);
}

TEST_F(DecoupledOnSmallCell, ReportsTheArmsOneByOne) {
  PlanReport report;
  const auto planned =
      planner_.plan(query_, {.strategy = Strategy::kDecoupled, .seed = 2, .deadline = 60}, &report);
  ASSERT_TRUE(planned) << planned.error().message;
  ASSERT_EQ(report.arm_times.size(), 2U);
  double slowest = 0;
  for (const ModuleTimes& times : report.arm_times) {
    EXPECT_GT(times.path_planning, 0);
    EXPECT_GT(times.plpp, 0);
    EXPECT_GT(times.trajectory, 0);
    EXPECT_EQ(times.coordination, 0);
    slowest = std::max(slowest, times.total);
  }
  EXPECT_LE(slowest, report.times.total);
  EXPECT_GT(report.times.coordination, 0);
  ASSERT_EQ(report.arms.size(), 2U);
  EXPECT_GT(report.arms[0].L_after, 0);
  EXPECT_GT(report.arms[1].L_after, 0);
  std::vector<std::string> phases;
  for (const Phase& phase : report.phases) {
    phases.push_back(phase.name);
    EXPECT_LT((phase.path.front() - planned->ends.start).norm(), 1e-12);
    EXPECT_LT((phase.path.back() - planned->ends.goal).norm(), 1e-12);
  }
  EXPECT_EQ(phases, (std::vector<std::string>{"planned", "simplified", "interpolated", "shortened",
                                              "simplified_again"}));
}

TEST_F(DecoupledOnSmallCell, AnArmThatStandsStillIsNoObstacleToTheReport) {
  auto ends = planner_.resolve(query_);
  ASSERT_TRUE(ends);
  const Eigen::Vector4d aside(0, -1.4, 0.5, 0);
  ends->start.tail(4) = ends->goal.tail(4) = aside;
  const auto planned = planner_.plan(*ends, {.strategy = Strategy::kDecoupled});
  ASSERT_TRUE(planned) << planned.error().message;
  for (const Phase& phase : planned->report.phases) {
    for (const VectorXd& q : phase.path) EXPECT_EQ(q.tail(4), ends->start.tail(4));
  }
  ends->goal = ends->start;
  const auto still = planner_.plan(*ends, {.strategy = Strategy::kDecoupled});
  ASSERT_TRUE(still) << still.error().message;
  EXPECT_LT(still->trajectory.duration(), 0.1);
}

TEST_F(DecoupledOnSmallCell, StopsOnRequestAndAtTheDeadline) {
  std::stop_source source;
  source.request_stop();
  const auto cancelled =
      planner_.plan(query_, {.strategy = Strategy::kDecoupled, .token = source.get_token()});
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
  const auto late = planner_.plan(query_, {.strategy = Strategy::kDecoupled, .deadline = 1e-6});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::kTimeout);
}

}  // namespace
}  // namespace tandem::pipeline
