#include "tandem/world/workcell.h"

#include <functional>

#include "small_cells.h"
#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/world/tool_poses.h"

namespace tandem::world {
namespace {

using test::arm_spec;
using test::ball;
using test::ball_geometry;
using test::make_cell;
using test::serial_robot;
using test::two_arms;

Eigen::VectorXd values(std::initializer_list<double> list) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), v.begin());
  return v;
}

Eigen::VectorXd random_q(const Workcell& cell, Rng& rng) {
  Eigen::VectorXd q(cell.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = rng.uniform(cell.lower()[i], cell.upper()[i]);
  return q;
}

TEST(Workcell, StacksTheJointsOfItsArmsInArmOrder) {
  WorkcellSpec spec = two_arms();
  std::swap(spec.arms[0], spec.arms[1]);
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  EXPECT_EQ(cell->dof(), 6);
  EXPECT_EQ(cell->arms()[0].name, "right");
  EXPECT_EQ(cell->arms()[0].offset, 0);
  EXPECT_EQ(cell->arms()[1].offset, 3);
  EXPECT_EQ(cell->find_arm("left"), 1);
  EXPECT_EQ(cell->find_arm("middle"), -1);
  EXPECT_EQ(cell->joint_names()[0], "right/to_a1");
  EXPECT_EQ(cell->joint_names()[5], "left/to_a3");
  EXPECT_EQ(cell->arms()[1].robot, 0);
  EXPECT_EQ(cell->model().links()[static_cast<std::size_t>(cell->arms()[1].tip_link)].name,
            "left/a3");
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(cell->lower()[static_cast<Eigen::Index>(i)], -2.0);
    EXPECT_EQ(cell->upper()[static_cast<Eigen::Index>(i)], 3.0);
    EXPECT_EQ(cell->limits()[i].velocity, 1.5);
    EXPECT_EQ(cell->limits()[i].acceleration, 10.0);
  }
}

// Each robot alone, placed by its base pose, is the oracle.
TEST(Workcell, PlacesEachRobotAsIfItWereAlone) {
  WorkcellSpec spec = two_arms();
  spec.robots[1].X_WB.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  spec.arms[1].X_LE.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  Rng rng(3);
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL, X_BL;
  for (int round = 0; round < 200; ++round) {
    const Eigen::VectorXd q = random_q(*cell, rng);
    cell->forward_kinematics(q, positions, X_WL);
    for (int r = 0; r < 2; ++r) {
      const RobotSpec& robot = spec.robots[static_cast<std::size_t>(r)];
      robot::forward_kinematics(robot.model, q.segment(3 * r, 3), X_BL);
      for (std::size_t i = 0; i < X_BL.size(); ++i) {
        const int link = cell->model().find_link(robot.name + "/" + robot.model.links()[i].name);
        EXPECT_TRUE(X_WL[static_cast<std::size_t>(link)].isApprox(robot.X_WB * X_BL[i], 1e-12));
      }
      EXPECT_TRUE(cell->tool_pose(r, X_WL).isApprox(
          robot.X_WB * X_BL.back() * spec.arms[static_cast<std::size_t>(r)].X_LE, 1e-12));
    }
  }
  EXPECT_THROW(cell->positions(Eigen::VectorXd::Zero(5), positions), ContractViolation);
}

TEST(Workcell, TellsWhereToolsAreAlongAPath) {
  const auto cell = make_cell(two_arms());
  Rng rng(4);
  std::vector<Eigen::VectorXd> path;
  for (const auto& none : tool_poses(*cell, path)) EXPECT_TRUE(none.empty());
  for (int i = 0; i < 7; ++i) path.push_back(random_q(*cell, rng));
  const auto tools = tool_poses(*cell, path);
  ASSERT_EQ(tools.size(), 2u);
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  for (std::size_t arm = 0; arm < 2; ++arm) {
    ASSERT_EQ(tools[arm].size(), path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      cell->forward_kinematics(path[i], positions, X_WL);
      const Eigen::Isometry3d X_WE = cell->tool_pose(static_cast<int>(arm), X_WL);
      EXPECT_EQ(tools[arm][i].matrix(), X_WE.matrix());
    }
  }
}

TEST(Workcell, HoldsOtherJointsWhereTheSpecPutsThem) {
  test::Tree tree;
  const int base = tree.add("base");
  tree.add("turned", base);
  tree.add("lifted", base);
  tree.joints.back().limits.lower = 0.2;
  tree.add("arm", base);
  WorkcellSpec spec;
  spec.name = "fixed";
  RobotSpec robot;
  robot.name = "r";
  robot.model = tree.make();
  robot.fixed_positions["to_turned"] = 1.25;
  spec.robots.push_back(robot);
  ArmSpec arm = arm_spec("arm", "r", "");
  arm.base = "base";
  arm.tip = "arm";
  spec.arms.push_back(arm);
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  EXPECT_EQ(cell->dof(), 1);
  Eigen::VectorXd positions;
  cell->positions(values({0.5}), positions);
  const auto at = [&](const char* joint) {
    const int index = cell->model().find_joint(joint);
    return positions[cell->model().joints()[static_cast<std::size_t>(index)].position_index];
  };
  EXPECT_EQ(at("r/to_turned"), 1.25);
  EXPECT_EQ(at("r/to_lifted"), 0.2);  // 0 is below its limit.
  EXPECT_EQ(at("r/to_arm"), 0.5);
}

TEST(Bodies, ComeFromVolumesPrimitivesObstaclesAndAttachedObjects) {
  WorkcellSpec spec = two_arms();
  test::Tree tree;
  const int base = tree.add("base");
  tree.add("a1", base);
  tree.add("bare", 1, robot::JointType::kFixed);
  tree.links[2].collision.clear();
  robot::Geometry box, cylinder;
  box.X_LG.translation() = Eigen::Vector3d(1, 0, 0);
  box.shape = robot::BoxGeometry{Eigen::Vector3d(0.2, 0.4, 0.6)};
  cylinder.shape = robot::CylinderGeometry{0.1, 0.5};
  tree.links[0].collision = {box, cylinder};
  robot::Geometry mesh;
  mesh.shape = robot::MeshGeometry{"package://p/a1.stl", "", Eigen::Vector3d::Ones()};
  tree.links[1].collision = {mesh};
  RobotSpec robot = serial_robot("extra", 1);
  robot.model = tree.make();
  robot.volumes["a1"] = {ball(0.3), ball(0.4)};
  spec.robots.push_back(robot);
  spec.attached.push_back({"part", "left/a3", {ball(0.05)}, {}});
  spec.padding = 0.01;
  spec.body_padding = {{"left/a1", 0.03}, {"table", 0.02}};
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  const auto body = [&](const char* name) {
    const int index = cell->find_body(name);
    EXPECT_GE(index, 0) << name;
    return cell->bodies()[static_cast<std::size_t>(std::max(index, 0))];
  };
  const Body base_body = body("extra/base");
  ASSERT_EQ(base_body.shapes_L.size(), 2u);
  EXPECT_EQ(base_body.shapes_L[0].type(), geometry::CoreType::kBox);
  EXPECT_NEAR(base_body.shapes_L[0].volume(), 0.2 * 0.4 * 0.6, 1e-12);
  EXPECT_TRUE(base_body.shapes_L[0].origin().isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_EQ(base_body.shapes_L[1].type(), geometry::CoreType::kCylinder);
  EXPECT_NEAR(base_body.shapes_L[1].volume(), M_PI * 0.01 * 0.5, 1e-12);
  ASSERT_EQ(body("extra/a1").shapes_L.size(), 2u);
  EXPECT_EQ(body("extra/a1").shapes_L[1].radius(), 0.4);
  EXPECT_EQ(cell->find_body("extra/bare"), -1);

  EXPECT_EQ(body("extra/a1").kind, Body::Kind::kRobotLink);
  EXPECT_EQ(body("table").kind, Body::Kind::kObstacle);
  EXPECT_EQ(body("table").link, 0);
  EXPECT_EQ(body("part").kind, Body::Kind::kAttached);
  EXPECT_EQ(body("part").link, cell->model().find_link("left/a3"));
  EXPECT_EQ(body("part").moved_by, 1u);

  EXPECT_EQ(body("left/a2").padding, 0.01);
  EXPECT_EQ(body("left/a1").padding, 0.03);
  EXPECT_EQ(body("part").padding, 0.01);
  EXPECT_EQ(body("table").padding, 0.02);
  EXPECT_EQ(body("left/a2").shapes_L[0].radius(), 0.1);  // Shapes stay unpadded.
}

TEST(Arms, OwnAGroupOrAChain) {
  WorkcellSpec spec = two_arms();
  spec.arms[0].group = "";
  spec.arms[0].base = "a1";
  spec.arms[0].tip = "a3";
  spec.arms[1].tip = "a2";
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  EXPECT_EQ(cell->dof(), 5);
  EXPECT_EQ(cell->arms()[0].dof(), 2);
  EXPECT_EQ(cell->joint_names()[0], "left/to_a2");
  EXPECT_EQ(cell->model().links()[static_cast<std::size_t>(cell->arms()[1].tip_link)].name,
            "right/a2");
  // The joint above the chain belongs to no arm and stands still.
  EXPECT_EQ(cell->bodies()[static_cast<std::size_t>(cell->find_body("left/a1"))].moved_by, 0u);
  const auto state = cell->named_state(0, "ready");
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().code, ErrorCode::kNotFound);
  EXPECT_NE(state.error().message.find("chain"), std::string::npos);
}

TEST(States, AreInTheOrderOfTheArm) {
  const auto cell = make_cell(two_arms());
  const auto ready = cell->named_state(1, "ready");
  ASSERT_TRUE(ready);
  EXPECT_TRUE(ready->isApprox(values({0.1, 0.2, 0.3})));
  const auto wrong = cell->named_state(0, "raedy");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kNotFound);
  EXPECT_NE(wrong.error().message.find("did you mean 'ready'"), std::string::npos);
  EXPECT_THROW(static_cast<void>(cell->named_state(2, "ready")), ContractViolation);

  WorkcellSpec partial = two_arms();
  partial.robots[0].semantics.states[0].values.erase("to_a2");
  const auto incomplete = make_cell(partial)->named_state(0, "ready");
  ASSERT_FALSE(incomplete);
  EXPECT_EQ(incomplete.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(incomplete.error().message.find("to_a2"), std::string::npos);
}

TEST(Limits, AreCheckedEntryByEntry) {
  const auto cell = make_cell(two_arms());
  Eigen::VectorXd q = Eigen::VectorXd::Zero(6);
  EXPECT_TRUE(cell->check_position_limits(q));
  EXPECT_TRUE(cell->check_position_limits(cell->lower()));
  EXPECT_TRUE(cell->check_position_limits(cell->upper()));
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (const double bad : {3.0000001, -2.0000001, std::nan("")}) {
      q.setZero();
      q[i] = bad;
      const auto checked = cell->check_position_limits(q);
      ASSERT_FALSE(checked);
      EXPECT_EQ(checked.error().code, ErrorCode::kInfeasible);
      EXPECT_NE(checked.error().message.find(cell->joint_names()[static_cast<std::size_t>(i)]),
                std::string::npos);
    }
  }
  q.setZero();
  q[4] = 3.0000001;
  EXPECT_EQ(cell->check_position_limits(q).error().message,
            "joint 'right/to_a2' is at 3.0000001, outside its limits [-2, 3]");
}

QuerySpec query_spec(const std::string& name) {
  QuerySpec query;
  query.name = name;
  query.start = {{"left", StateGoal{"ready"}}, {"right", JointGoal{values({0, 1, 2})}}};
  query.goal = {{"right", PoseGoal{}}};
  return query;
}

TEST(Queries, AreResolvedByArm) {
  WorkcellSpec spec = two_arms();
  spec.queries = {query_spec("first"), query_spec("second")};
  spec.queries[1].start.clear();
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  const Query& first = cell->query("first");
  ASSERT_EQ(first.start.size(), 2u);
  EXPECT_EQ(std::get<StateGoal>(*first.start[0]).name, "ready");
  EXPECT_EQ(std::get<JointGoal>(*first.start[1]).q[2], 2.0);
  EXPECT_FALSE(first.goal[0]);
  EXPECT_TRUE(std::holds_alternative<PoseGoal>(*first.goal[1]));
  const Query& second = cell->query("second");
  ASSERT_EQ(second.start.size(), 2u);
  EXPECT_FALSE(second.start[0] || second.start[1]);

  const auto missing = cell->find_query("frist");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("did you mean 'first'"), std::string::npos);
  EXPECT_THROW(cell->query("frist"), ContractViolation);
  EXPECT_THROW(cell->describe_pair(-1), ContractViolation);
  EXPECT_THROW(cell->describe_pair(static_cast<int>(cell->pairs().size())), ContractViolation);
}

struct Fault {
  const char* name;
  std::function<void(WorkcellSpec&)> spoil;
  ErrorCode code;
  std::vector<const char*> says;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void set_limits(WorkcellSpec& spec, std::function<void(robot::JointLimits&)> change) {
  robot::Model& model = spec.robots[0].model;
  robot::JointLimits limits = model.joints()[1].limits;
  change(limits);
  model.set_limits(1, limits);
}

using S = WorkcellSpec;
const ErrorCode kInvalid = ErrorCode::kInvalidInput, kAbsent = ErrorCode::kNotFound;
const std::vector<Fault> kFaults = {
    {"no robot", [](S& s) { s.robots.clear(); }, kInvalid, {"at least one robot"}},
    {"no arm", [](S& s) { s.arms.clear(); }, kInvalid, {"at least one arm"}},
    {"many arms", [](S& s) { s.arms.resize(33, s.arms[0]); }, ErrorCode::kUnsupported, {"33"}},
    {"robot twice", [](S& s) { s.robots[1].name = "left"; }, kInvalid, {"robot 'left'"}},
    {"robot unnamed", [](S& s) { s.robots[1].name = ""; }, kInvalid, {"robot without a name"}},
    {"robot slash", [](S& s) { s.robots[1].name = "a/b"; }, kInvalid, {"'a/b'", "'/'"}},
    {"robot pose", [](S& s) { s.robots[0].X_WB.linear() *= 2; }, kInvalid, {"left", "base pose"}},
    {"arm twice", [](S& s) { s.arms[1].name = "left"; }, kInvalid, {"arm 'left'", "rename"}},
    {"arm robot", [](S& s) { s.arms[0].robot = "lefd"; }, kAbsent, {"'lefd'", "mean 'left'"}},
    {"arm group", [](S& s) { s.arms[0].group = "amr"; }, kAbsent, {"'amr'", "mean 'arm'"}},
    {"no SRDF", [](S& s) { s.robots[0].semantics = {}; }, kAbsent, {"SRDF", "base and tip"}},
    {"group and base", [](S& s) { s.arms[0].base = "base"; }, kInvalid, {"not both"}},
    {"neither", [](S& s) { s.arms[0].group = ""; }, kInvalid, {"either an SRDF group"}},
    {"arm tip", [](S& s) { s.arms[0].tip = "a33"; }, kAbsent, {"'a33'", "mean 'a3'"}},
    {"no tip",
     [](S& s) { s.robots[0].semantics.groups[0].tip_link = -1; },
     kInvalid,
     {"arm 'left'", "tip link"}},
    {"still tip", [](S& s) { s.arms[0].tip = "base"; }, kInvalid, {"none of its joints moves"}},
    {"chain without tip",
     [](S& s) { s.arms[0].group = "", s.arms[0].base = "base"; },
     kInvalid,
     {"no tip"}},
    {"chain upwards",
     [](S& s) { s.arms[0].group = "", s.arms[0].base = "a3", s.arms[0].tip = "a1"; },
     kInvalid,
     {"not below"}},
    {"chain base",
     [](S& s) { s.arms[0].group = "", s.arms[0].base = "bas", s.arms[0].tip = "a1"; },
     kAbsent,
     {"mean 'base'"}},
    {"empty group",
     [](S& s) { s.robots[0].semantics.groups[0].joints.clear(); },
     kInvalid,
     {"no movable joint"}},
    {"tool", [](S& s) { s.arms[0].X_LE.linear() *= -1; }, kInvalid, {"tool"}},
    {"shared joint",
     [](S& s) { s.arms[1].robot = "left"; },
     kInvalid,
     {"arm 'right'", "left/to_a1", "arm 'left'"}},
    {"velocity",
     [](S& s) { set_limits(s, [](auto& l) { l.velocity = kInfinity; }); },
     kInvalid,
     {"left/to_a2", "velocity", "joint_limits", "limits: {to_a2:"}},
    {"acceleration",
     [](S& s) { set_limits(s, [](auto& l) { l.acceleration = kInfinity; }); },
     kInvalid,
     {"left/to_a2", "acceleration", "joint_limits"}},
    {"position",
     [](S& s) { set_limits(s, [](auto& l) { l.lower = -kInfinity; }); },
     kInvalid,
     {"left/to_a2", "position"}},
    {"fixed name",
     [](S& s) { s.robots[0].fixed_positions["to_x1"] = 0; },
     kAbsent,
     {"to_x1", "mean 'to_a1'"}},
    {"fixed owned",
     [](S& s) { s.robots[0].fixed_positions["to_a1"] = 0; },
     kInvalid,
     {"to_a1", "arm 'left'"}},
    {"fixed range",
     [](S& s) {
       s.arms[0].tip = "a3";
       s.arms[0].base = "a1";
       s.arms[0].group = "";
       s.robots[0].fixed_positions["to_a1"] = 3.5;
     },
     kInvalid,
     {"to_a1", "3.5", "limits"}},
    {"mesh",
     [](S& s) {
       test::Tree tree;
       tree.add("a1", tree.add("base"));
       robot::Geometry mesh;
       mesh.shape = robot::MeshGeometry{"package://p/a1.stl", "", Eigen::Vector3d::Ones()};
       tree.links[1].collision.push_back(mesh);
       s.robots[0].model = tree.make();
       s.robots[0].semantics.groups[0] = {"arm", {0}, 1};
       s.robots[0].semantics.disabled_pairs.clear();
     },
     kAbsent,
     {"link 'a1'", "robot 'left'", "package://p/a1.stl", "volumes:"}},
    {"volumes name",
     [](S& s) { s.robots[0].volumes["a4"] = {ball()}; },
     kAbsent,
     {"'a4'", "did you mean"}},
    {"volumes empty", [](S& s) { s.robots[0].volumes["a3"] = {}; }, kInvalid, {"'a3'", "empty"}},
    {"SRDF link",
     [](S& s) { s.robots[0].semantics.disabled_pairs.push_back({"a1", "a9", ""}); },
     kAbsent,
     {"'a9'", "mean 'a1'"}},
    {"obstacle unnamed", [](S& s) { s.obstacles[0].name = ""; }, kInvalid, {"no name"}},
    {"obstacle twice",
     [](S& s) { s.obstacles.push_back(s.obstacles[0]); },
     kInvalid,
     {"'table'", "rename"}},
    {"obstacle as link", [](S& s) { s.obstacles[0].name = "left/a1"; }, kInvalid, {"'left/a1'"}},
    {"obstacle surface",
     [](S& s) { s.obstacles[0].surfaces_W.push_back({}); },
     kInvalid,
     {"'table'", "mesh or cloud"}},
    {"obstacle empty",
     [](S& s) { s.obstacles[0].shapes_W.clear(); },
     kInvalid,
     {"'table'", "no shapes"}},
    {"attached link",
     [](S& s) { s.attached.push_back({"part", "a3", {ball()}, {}}); },
     kAbsent,
     {"'part'", "'a3'", "ROBOT/LINK"}},
    {"attached touching",
     [](S& s) { s.attached.push_back({"part", "left/a3", {ball()}, {"tabel"}}); },
     kAbsent,
     {"'tabel'", "mean 'table'"}},
    {"allowed name",
     [](S& s) { s.allowed.push_back({"left/a1", "tabel", "x"}); },
     kAbsent,
     {"'tabel'", "mean 'table'"}},
    {"allowed itself",
     [](S& s) { s.allowed.push_back({"table", "table", "x"}); },
     kInvalid,
     {"itself"}},
    {"padding negative", [](S& s) { s.padding = -0.01; }, kInvalid, {"padding", "-0.01"}},
    {"padding nan", [](S& s) { s.body_padding["table"] = std::nan(""); }, kInvalid, {"'table'"}},
    {"padding name", [](S& s) { s.body_padding["tabel"] = 0; }, kAbsent, {"'tabel'", "padding"}},
    {"query twice", [](S& s) { s.queries.push_back(s.queries[0]); }, kInvalid, {"query 'move'"}},
    {"query arm",
     [](S& s) { s.queries[0].goal["lefd"] = StateGoal{"ready"}; },
     kAbsent,
     {"goal of query 'move'", "mean 'left'"}},
    {"query size",
     [](S& s) { s.queries[0].start["right"] = JointGoal{values({1, 2})}; },
     kInvalid,
     {"start of query 'move'", "arm 'right'", "3 joints", "2 values"}},
    {"query nan",
     [](S& s) { s.queries[0].goal["right"] = JointGoal{values({1, 2, std::nan("")})}; },
     kInvalid,
     {"finite"}},
    {"query state",
     [](S& s) { s.queries[0].goal["left"] = StateGoal{"home"}; },
     kAbsent,
     {"'home'", "ready"}},
    {"query pose",
     [](S& s) {
       PoseGoal goal;
       goal.X_WE.linear().setZero();
       s.queries[0].goal["left"] = goal;
     },
     kInvalid,
     {"rigid"}},
    {"query no goal", [](S& s) { s.queries[0].goal.clear(); }, kInvalid, {"no goal"}},
    {"query no start",
     [](S& s) { s.queries[0].start.erase("right"); },
     kInvalid,
     {"no start for arm 'right'"}},
};

TEST(Faults, AreReportedWithNameAndRemedy) {
  for (const Fault& fault : kFaults) {
    SCOPED_TRACE(fault.name);
    WorkcellSpec spec = two_arms();
    spec.queries = {query_spec("move")};
    ASSERT_TRUE(Workcell::make(spec));
    fault.spoil(spec);
    const auto cell = Workcell::make(spec);
    ASSERT_FALSE(cell);
    EXPECT_EQ(cell.error().code, fault.code) << cell.error().message;
    for (const char* said : fault.says) {
      EXPECT_NE(cell.error().message.find(said), std::string::npos)
          << "'" << said << "' is not in: " << cell.error().message;
    }
  }
}

TEST(Faults, BeginWithThePlaceOfTheirEntry) {
  WorkcellSpec spec = two_arms();
  spec.file = "cell.yaml";
  spec.arms[1].where = "cell.yaml:12:5";
  spec.arms[1].group = "gripper";
  const auto cell = Workcell::make(spec);
  ASSERT_FALSE(cell);
  EXPECT_EQ(cell.error().message.find("cell.yaml:12:5: arm 'right': "), 0u) << cell.error().message;
}

TEST(Faults, LinksWithoutShapesAreNoBodies) {
  WorkcellSpec spec = two_arms();
  test::Tree tree;
  tree.add("a1", tree.add("base"));
  tree.links[0].collision.clear();
  spec.robots[0].model = tree.make();
  spec.robots[0].semantics.groups[0] = {"arm", {0}, 1};
  spec.robots[0].semantics.disabled_pairs = {{"base", "a1", "Adjacent"}};
  ASSERT_TRUE(make_cell(spec));
  EXPECT_EQ(make_cell(spec)->find_body("left/base"), -1);
  spec.allowed = {{"left/base", "table", "bolted"}};
  const auto cell = Workcell::make(spec);
  ASSERT_FALSE(cell);
  EXPECT_NE(cell.error().message.find("'left/base' has no shapes"), std::string::npos);
}

}  // namespace
}  // namespace tandem::world
