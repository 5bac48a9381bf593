#include "robots.h"
#include "tandem/robot/kinematics.h"
#include "tandem/robot/model.h"

namespace tandem::robot {
namespace {

using test::expect_error;
using test::named_joint;
using test::named_link;

/// Root `root`, links a and b, the joint of b following that of a.
Model two_joints(const std::string& root) {
  std::vector<Joint> joints = {named_joint("ja", JointType::kRevolute, 0, 1),
                               named_joint("jb", JointType::kRevolute, 1, 2)};
  joints[0].X_PJ.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
  joints[1].X_PJ.translation() = Eigen::Vector3d(0.4, 0, 0);
  joints[1].mimic = Mimic{0, -2, 0.1};
  return *Model::make("two", {named_link(root), named_link("a"), named_link("b")}, joints);
}

std::vector<std::string> link_names(const Model& model) {
  std::vector<std::string> names;
  for (const Link& link : model.links()) names.push_back(link.name);
  return names;
}

TEST(Merge, PlacesRobotsInOneTree) {
  Rng rng(11);
  const Model robot = two_joints("base");
  const std::vector<Placement> placements = {{&robot, "left/", test::random_pose(rng)},
                                             {&robot, "right/", test::random_pose(rng)}};
  const auto cell = merge("cell", placements);
  ASSERT_TRUE(cell) << cell.error().message;
  EXPECT_EQ(link_names(*cell), (std::vector<std::string>{"world", "left/base", "left/a", "left/b",
                                                         "right/base", "right/a", "right/b"}));
  ASSERT_EQ(cell->position_count(), 2);
  EXPECT_EQ(cell->joint_of_position(0), cell->find_joint("left/ja"));
  EXPECT_EQ(cell->joint_of_position(1), cell->find_joint("right/ja"));
  EXPECT_EQ(cell->moving_ancestors(cell->find_link("right/b")),
            std::vector<int>{cell->find_joint("right/ja")});

  const Eigen::Vector2d q(0.3, -0.7);
  LinkPoses X_WL, X_BL;
  forward_kinematics(*cell, q, X_WL);
  for (int i = 0; i < 2; ++i) {
    const Placement& placement = placements[static_cast<std::size_t>(i)];
    forward_kinematics(robot, q.segment<1>(i), X_BL);
    for (std::size_t k = 0; k < robot.links().size(); ++k) {
      const int link = cell->find_link(placement.prefix + robot.links()[k].name);
      EXPECT_TRUE(X_WL[static_cast<std::size_t>(link)].isApprox(placement.X_WB * X_BL[k], 1e-12));
    }
  }
}

TEST(Merge, OfOneRobotKeepsEverything) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    SCOPED_TRACE(files.urdf);
    Rng rng(5);
    const Model robot = test::load(files.urdf);
    const Eigen::Isometry3d X_WB = test::random_pose(rng);
    const auto cell = merge("cell", {{&robot, "r/", X_WB}});
    ASSERT_TRUE(cell) << cell.error().message;
    ASSERT_EQ(cell->links().size(), robot.links().size() + 1);
    ASSERT_EQ(cell->position_count(), robot.position_count());
    const Eigen::VectorXd q = test::random_positions(robot, rng);
    LinkPoses X_WL, X_BL;
    forward_kinematics(*cell, q, X_WL);
    forward_kinematics(robot, q, X_BL);
    for (std::size_t k = 0; k < robot.links().size(); ++k) {
      EXPECT_EQ(cell->links()[k + 1].name, "r/" + robot.links()[k].name);
      EXPECT_EQ(cell->links()[k + 1].collision.size(), robot.links()[k].collision.size());
      EXPECT_TRUE(X_WL[k + 1].isApprox(X_WB * X_BL[k], 1e-12));
    }
  }
}

TEST(Merge, TakesARootCalledWorldAsItsOwn) {
  Model robot = two_joints("world");
  const Model other = two_joints("base");
  const auto cell = merge("cell", {{&robot, ""}, {&other, "o/"}});
  ASSERT_TRUE(cell) << cell.error().message;
  EXPECT_EQ(link_names(*cell),
            (std::vector<std::string>{"world", "a", "b", "o/base", "o/a", "o/b"}));
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation().x() = 1;
  expect_error(merge("cell", {{&robot, "", X_WB}}), ErrorCode::kInvalidInput,
               {"'two'", "root link 'world'"});
  const auto placed = merge("cell", {{&robot, "p/", X_WB}});
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(link_names(*placed), (std::vector<std::string>{"world", "p/world", "p/a", "p/b"}));
}

TEST(Merge, KeepsTheGeometryOfTheCommonRoot) {
  Link root = named_link("world");
  root.collision.push_back({Eigen::Isometry3d::Identity(), SphereGeometry{0.1}});
  const Model robot = *Model::make("r", {root}, {});
  const auto cell = merge("cell", {{&robot, ""}});
  ASSERT_TRUE(cell) << cell.error().message;
  EXPECT_EQ(cell->links()[0].collision.size(), 1u);
}

TEST(Merge, RejectsNamesThatExistTwice) {
  const Model robot = two_joints("base");
  expect_error(merge("cell", {{&robot, "a/"}, {&robot, "a/"}}), ErrorCode::kInvalidInput,
               {"'a/base' exists twice"});
  const Model world_inside = *Model::make("w", {named_link("base"), named_link("world")},
                                          {named_joint("j", JointType::kFixed, 0, 1)});
  expect_error(merge("cell", {{&world_inside, ""}}), ErrorCode::kInvalidInput,
               {"'world' exists twice"});
}

TEST(Merge, OfNothingIsTheWorld) {
  const auto cell = merge("cell", {});
  ASSERT_TRUE(cell) << cell.error().message;
  EXPECT_EQ(link_names(*cell), std::vector<std::string>{"world"});
  EXPECT_EQ(cell->position_count(), 0);
}

}  // namespace
}  // namespace tandem::robot
