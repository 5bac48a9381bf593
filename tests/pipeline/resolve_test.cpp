#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {
namespace {

TEST(Resolve, StartDefaultsToTheGoalBefore) {
  const auto cell = test::small_cell();
  const auto cross = resolve(cell, cell->query("cross"));
  const auto back = resolve(cell, cell->query("back"));
  ASSERT_TRUE(cross && back);
  EXPECT_EQ(back->start, cross->goal);
  EXPECT_DOUBLE_EQ(back->goal[1], -1.4);
  EXPECT_DOUBLE_EQ(back->goal[5], -1.4);
}

TEST(Resolve, ArmWithoutGoalStays) {
  auto spec = test::small_cell_spec();
  spec.queries[0].goal.erase("right");
  const auto cell = *world::Workcell::make(spec);
  const auto cross = resolve(cell, cell->query("cross"));
  ASSERT_TRUE(cross);
  EXPECT_EQ(cross->goal.tail(4), cross->start.tail(4));
  EXPECT_NE(cross->goal.head(4), cross->start.head(4));
}

TEST(Resolve, AQueryOfItsOwnNeedsAStart) {
  const auto cell = test::small_cell();
  world::Query own = cell->query("back");
  own.name = "not in the cell";
  const auto resolved = resolve(cell, own);
  ASSERT_FALSE(resolved);
  EXPECT_NE(resolved.error().message.find("'left' has no start"), std::string::npos)
      << resolved.error().message;
}

// The tool pose of a known configuration, as a goal: the solution must reach it, free of
// collisions.
TEST(Resolve, PosesAreReachedWithoutCollision) {
  auto spec = test::small_cell_spec();
  const auto cell = test::small_cell();
  const auto cross = resolve(cell, cell->query("cross"));
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  cell->forward_kinematics(cross->goal, positions, X_WL);
  spec.queries[0].goal["left"] = world::PoseGoal{cell->tool_pose(0, X_WL)};
  const auto with_pose = *world::Workcell::make(spec);
  const auto solved = resolve(with_pose, with_pose->query("cross"));
  ASSERT_TRUE(solved) << solved.error().message;
  ASSERT_TRUE(check_ends(*with_pose, *solved));
  robot::LinkPoses reached;
  with_pose->forward_kinematics(solved->goal, positions, reached);
  EXPECT_LT((with_pose->tool_pose(0, reached).matrix() - cell->tool_pose(0, X_WL).matrix()).norm(),
            1e-5);
}

TEST(Resolve, PoseOutOfReachSaysSo) {
  auto spec = test::small_cell_spec();
  world::PoseGoal far;
  far.X_WE.translation().x() = 5;
  spec.queries[0].goal["left"] = far;
  const auto cell = *world::Workcell::make(spec);
  const auto solved = resolve(cell, cell->query("cross"));
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(solved.error().message.find("goal of query 'cross', arm 'left'"), std::string::npos);
  EXPECT_NE(solved.error().message.find("reach"), std::string::npos) << solved.error().message;
}

// A tool pose whose only configurations put the arm through the table.
TEST(Resolve, BlockedPoseNamesThePair) {
  auto spec = test::small_cell_spec();
  auto free_spec = spec;
  free_spec.obstacles.clear();
  const auto free_cell = *world::Workcell::make(free_spec);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(8), positions;
  q << 0.1, 0.7, 0.2, 0.1, 0, -1.4, 0.5, 0;
  robot::LinkPoses X_WL;
  free_cell->forward_kinematics(q, positions, X_WL);
  spec.queries[0].goal["left"] = world::PoseGoal{free_cell->tool_pose(0, X_WL)};
  const auto cell = *world::Workcell::make(spec);
  const auto solved = resolve(cell, cell->query("cross"));
  ASSERT_FALSE(solved);
  EXPECT_NE(solved.error().message.find("table"), std::string::npos) << solved.error().message;
}

TEST(CheckEnds, NamesThePairAndDepth) {
  const auto cell = test::small_cell();
  auto ends = *resolve(cell, cell->query("cross"));
  ASSERT_TRUE(check_ends(*cell, ends));
  ends.goal[1] = 1.0;  // Pitches the left arm through the table.
  const auto checked = check_ends(*cell, ends);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(checked.error().message.find("goal of query 'cross'"), std::string::npos);
  EXPECT_NE(checked.error().message.find("table"), std::string::npos) << checked.error().message;
  EXPECT_NE(checked.error().message.find("deep"), std::string::npos);
}

TEST(CheckEnds, NamesTheJointOutsideItsLimit) {
  const auto cell = test::small_cell();
  auto ends = *resolve(cell, cell->query("cross"));
  ends.start[6] = 3.0;
  const auto checked = check_ends(*cell, ends);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("right/joint3"), std::string::npos)
      << checked.error().message;
}

}  // namespace
}  // namespace tandem::pipeline
