// One arm of a cell as a cell of its own.

#include "small_cells.h"
#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::world {
namespace {

using Eigen::VectorXd;

/// Three robots, each with a tool in its hand; arms of 2, 3 and 4 joints with limits of their own.
WorkcellSpec three_arms() {
  WorkcellSpec spec = test::two_arms();
  spec.robots[0] = test::serial_robot("left", 2);
  spec.robots.push_back(test::serial_robot("far", 4));
  spec.robots[2].X_WB.translation() = Eigen::Vector3d(3, 1, 0);
  spec.arms.push_back(test::arm_spec("far", "far", "arm"));
  spec.padding = 0.002;
  for (std::size_t i = 0; i < spec.arms.size(); ++i) {
    const std::string tip = test::numbered("a", static_cast<int>(i) + 2);
    spec.arms[i].X_LE.translation() = Eigen::Vector3d(0.1, 0.01 * static_cast<double>(i), 0);
    AttachedSpec tool;
    tool.name = spec.arms[i].name + "_tool";
    tool.link = spec.arms[i].robot + "/" + tip;
    tool.shapes_L = {test::ball(0.02)};
    spec.attached.push_back(tool);
  }
  spec.allowed = {{"right_tool", "table", "it works there"}, {"far/a1", "left/a1", "never meet"}};
  const ArmGoal ready = StateGoal{"ready"};
  QuerySpec query{"go", {}, {{"right", ready}}};
  for (const ArmSpec& arm : spec.arms) query.start[arm.name] = ready;
  spec.queries = {query};
  return spec;
}

void expect_part(const Workcell& whole, const Workcell& alone, int i) {
  const Arm& arm = whole.arms()[static_cast<std::size_t>(i)];
  ASSERT_EQ(alone.arms().size(), 1U);
  EXPECT_EQ(alone.arms()[0].name, arm.name);
  EXPECT_EQ(alone.arms()[0].offset, 0);
  EXPECT_EQ(alone.left_out().size(), whole.arms().size() - 1);
  ASSERT_EQ(alone.dof(), arm.dof());
  EXPECT_EQ(alone.lower(), whole.lower().segment(arm.offset, arm.dof()));
  EXPECT_EQ(alone.upper(), whole.upper().segment(arm.offset, arm.dof()));
  for (int j = 0; j < arm.dof(); ++j) {
    const auto own = static_cast<std::size_t>(j), all = static_cast<std::size_t>(arm.offset + j);
    EXPECT_EQ(alone.joint_names()[own], whole.joint_names()[all]);
    EXPECT_EQ(alone.limits()[own].velocity, whole.limits()[all].velocity);
  }
  const PairSelection kept = whole.select(PairScope::arm(i));
  ASSERT_EQ(alone.pairs().size(), kept.size());
  ASSERT_EQ(alone.select(PairScope::all()).size(), kept.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const BodyPair& pair = whole.pairs()[static_cast<std::size_t>(kept[k])];
    EXPECT_EQ(alone.pairs()[k].a, pair.a);
    EXPECT_EQ(alone.pairs()[k].b, pair.b);
    EXPECT_EQ(alone.pairs()[k].moved_by, 1U);
  }
  EXPECT_EQ(alone.pairs().size() + alone.skipped_pairs().size(),
            whole.pairs().size() + whole.skipped_pairs().size());
}

TEST(ArmAlone, HasItsJointsAndThePairsThatItAloneMoves) {
  const auto whole = test::make_cell(three_arms());
  for (int i = 0; i < 3; ++i) {
    const auto alone = whole->arm_alone(i);
    expect_part(*whole, *alone, i);
    EXPECT_FALSE(alone->pairs().empty());
    EXPECT_TRUE(alone->queries().empty());
    EXPECT_EQ(alone->named_state(0, "ready")->size(), alone->dof());
  }
  EXPECT_THROW(whole->arm_alone(3), ContractViolation);
  const auto right = whole->arm_alone(1);
  EXPECT_EQ(test::pair_state(*right, "right/a2", "table"), "checked");
  EXPECT_EQ(test::pair_state(*right, "right_tool", "table"), "allowed: it works there");
  EXPECT_EQ(test::pair_state(*right, "right/a2", "left/a2"), "an arm that is left out moves them");
  EXPECT_EQ(test::pair_state(*right, "left/a1", "table"), "an arm that is left out moves them");
  // The others' bases stand still, so they are obstacles.
  EXPECT_EQ(test::pair_state(*right, "right/a2", "left/base"), "checked");
}

TEST(ArmAlone, ToolsAreWhereTheyAreInTheWholeCell) {
  const auto whole = test::make_cell(three_arms());
  Rng rng(5);
  VectorXd positions;
  robot::LinkPoses X_WL;
  for (int k = 0; k < 50; ++k) {
    VectorXd q(whole->dof());
    for (double& value : q) value = rng.uniform(-2, 2);
    for (int i = 0; i < 3; ++i) {
      whole->forward_kinematics(q, positions, X_WL);
      const Eigen::Isometry3d X_WE = whole->tool_pose(i, X_WL);
      const Arm& arm = whole->arms()[static_cast<std::size_t>(i)];
      const auto alone = whole->arm_alone(i);
      alone->forward_kinematics(q.segment(arm.offset, arm.dof()), positions, X_WL);
      EXPECT_TRUE(alone->tool_pose(0, X_WL).isApprox(X_WE, 1e-14));
    }
  }
}

TEST(ArmAlone, FollowsWhatIsCarried) {
  const auto whole = test::make_cell(three_arms());
  SceneState scene;
  scene.objects["table"] = {"left/a2", Eigen::Isometry3d::Identity(), {"left/a1"}};
  scene.objects["right_tool"] = {kWorldLink, Eigen::Isometry3d::Identity(), {}};
  const auto changed = whole->in_scene(scene);
  ASSERT_TRUE(changed) << changed.error().message;
  for (int i = 0; i < 3; ++i) {
    const auto alone = (*changed)->arm_alone(i);
    expect_part(**changed, *alone, i);
    // The same part by the other way round, and back again.
    const auto moved = whole->arm_alone(i)->in_scene(scene);
    ASSERT_TRUE(moved) << moved.error().message;
    expect_part(**changed, **moved, i);
    const auto home = (*moved)->in_scene({});
    ASSERT_TRUE(home) << home.error().message;
    expect_part(*whole, **home, i);
  }
  EXPECT_EQ(test::pair_state(*(*changed)->arm_alone(2), "far/a3", "table"),
            "an arm that is left out moves them");
  EXPECT_EQ(test::pair_state(*(*changed)->arm_alone(2), "far/a3", "right_tool"), "checked");
  SceneChanges changes;
  changes.detach.push_back({"left_tool"});
  EXPECT_THROW(static_cast<void>(whole->arm_alone(0)->scene_after(changes, VectorXd::Zero(2))),
               ContractViolation);
}

}  // namespace
}  // namespace tandem::world
