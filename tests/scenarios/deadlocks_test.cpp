// Two Pandas that face each other over one workspace: queries of which it is known whether their
// motions can be coordinated, and what helps where they cannot.

#include <gtest/gtest.h>

#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/planner.h"
#include "tandem/verification/verify.h"
#include "test_data.h"

namespace tandem {
namespace {

using pipeline::Strategy;
using Cell = std::shared_ptr<const world::Workcell>;

/// The tool 0.6 m before the base, 0.4 m above it, turned by `turn` about it [rad].
world::ArmGoal reach(double turn) {
  Eigen::VectorXd q(7);
  q << turn, 0.3, 0, -1.9, 0, 2.2, 0.785;
  return world::JointGoal{q};
}

/// Where each arm is turned to, from and to: 0 is the middle, where the other one reaches as well.
/// The left arm turns to its left with positive angles, and so does the right one, which looks
/// back.
struct Turns {
  const char* name;
  double left_from, right_from, left_to, right_to;
};

Cell facing_cell(const std::vector<Turns>& queries) {
  const auto gearbox = io::load_workcell(test::source_path("scenarios/gearbox/workcell.yaml"));
  if (!gearbox) return nullptr;
  world::WorkcellSpec spec = (*gearbox)->spec();
  spec.name = "facing";
  spec.robots[0].X_WB = spec.robots[1].X_WB = Eigen::Isometry3d::Identity();
  spec.robots[1].X_WB.translation().x() = 1.0;
  spec.robots[1].X_WB.linear() =
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  X_WO.translation() = Eigen::Vector3d(0.5, 0, -0.08);
  spec.obstacles = {{"floor", {*geometry::Shape::box(X_WO, {3, 3, 0.1})}}};
  spec.attached.clear();
  spec.allowed.clear();
  spec.body_padding.clear();
  spec.lists.clear();
  spec.queries.clear();
  for (const Turns& turns : queries) {
    spec.queries.push_back({turns.name,
                            {{"left", reach(turns.left_from)}, {"right", reach(turns.right_from)}},
                            {{"left", reach(turns.left_to)}, {"right", reach(turns.right_to)}}});
  }
  auto cell = world::Workcell::make(std::move(spec));
  EXPECT_TRUE(cell) << (cell ? "" : cell.error().message);
  return cell ? *cell : nullptr;
}

class Deadlocks : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(cell_, nullptr); }

  /// The ladder ends at this rung, for several seeds, with a motion that FCL has nothing against.
  void expect_rung(const char* query, const std::string& rung) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto plan = planner_.plan(
          cell_->query(query), {.strategy = Strategy::kDecoupled, .seed = seed, .deadline = 60});
      ASSERT_TRUE(plan) << query << ": " << plan.error().message;
      EXPECT_TRUE(plan->report.rungs.contains(rung)) << query << ", seed " << seed;
      const auto checked =
          verification::verify(cell_, plan->trajectory, plan->ends.start, plan->ends.goal);
      ASSERT_TRUE(checked) << checked.error().message;
      EXPECT_TRUE(checked->ok()) << query << ": " << checked->failures.front();
    }
  }

  void expect_infeasible(const char* query) {
    const auto plan = planner_.plan(cell_->query(query), {.strategy = Strategy::kDecoupled});
    ASSERT_FALSE(plan) << query;
    EXPECT_EQ(plan.error().code, ErrorCode::kInfeasible);
    EXPECT_NE(plan.error().message.find("goal of query"), std::string::npos)
        << plan.error().message;
  }

  Cell cell_ = facing_cell({{"swap", -0.7, -0.7, 0.7, 0.7},
                            {"follow", 0, 0.8, 0.8, 0},
                            {"leave", -0.8, 0, 0, -0.8},
                            {"parked", -0.7, 0, 0.7, 0},
                            {"parked_at_goal", -0.7, 0, 0.05, 0},
                            {"one_goal", -0.7, -0.7, 0, 0}});
  pipeline::Planner planner_{cell_};
};

TEST_F(Deadlocks, AnArmFollowsTheOtherThroughTheMiddle) { expect_rung("follow", "coordinated"); }

TEST_F(Deadlocks, AnArmWaitsUntilTheOtherHasLeftItsGoal) { expect_rung("leave", "coordinated"); }

TEST_F(Deadlocks, ArmsThatSwapSidesGoAroundEachOther) { expect_rung("swap", "prioritized"); }

TEST_F(Deadlocks, AnArmParkedInTheMiddleIsGoneAround) { expect_rung("parked", "prioritized"); }

TEST_F(Deadlocks, AnArmParkedAtTheOthersGoalIsInfeasible) { expect_infeasible("parked_at_goal"); }

TEST_F(Deadlocks, OneGoalForBothIsInfeasible) { expect_infeasible("one_goal"); }

TEST_F(Deadlocks, AutoPlansTogetherWhereTheArmsBlockEachOther) {
  for (const char* query : {"swap", "parked"}) {
    const auto plan =
        planner_.plan(cell_->query(query), {.strategy = Strategy::kAuto, .deadline = 60});
    ASSERT_TRUE(plan) << plan.error().message;
    EXPECT_TRUE(plan->report.rungs.contains("centralized")) << query;
  }
}

}  // namespace
}  // namespace tandem
