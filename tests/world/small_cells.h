#pragma once
/// Robots and cells small enough to reason about by hand.

#include <gtest/gtest.h>

#include "tandem/world/workcell.h"

namespace tandem::test {

/// "a" and 3 give "a3".
inline std::string numbered(std::string name, int number) {
  return name.append(std::to_string(number));
}

inline geometry::Shape ball(double radius = 0.1) {
  return *geometry::Shape::sphere(Eigen::Vector3d::Zero(), radius);
}

inline robot::Geometry ball_geometry(double radius = 0.1) {
  robot::Geometry piece;
  piece.shape = robot::SphereGeometry{radius};
  return piece;
}

inline robot::JointLimits full_limits() { return {-2.0, 3.0, 1.5, 10.0}; }

/// Links and joints of a robot under construction.
struct Tree {
  std::vector<robot::Link> links;
  std::vector<robot::Joint> joints;

  /// A link with one ball; the first is the root, others hang on `parent` by a joint about z.
  int add(const std::string& name, int parent = -1,
          robot::JointType type = robot::JointType::kRevolute) {
    const int index = static_cast<int>(links.size());
    robot::Link link;
    link.name = name;
    link.collision.push_back(ball_geometry());
    links.push_back(std::move(link));
    if (parent < 0) return index;
    robot::Joint joint;
    joint.name = "to_" + name;
    joint.type = type;
    joint.parent_link = parent;
    joint.child_link = index;
    joint.axis_J = Eigen::Vector3d::UnitZ();
    joint.X_PJ.translation() = Eigen::Vector3d(0.5, 0, 0);
    joint.limits = full_limits();
    joints.push_back(std::move(joint));
    return index;
  }
  robot::Model make(const std::string& name = "robot") const {
    return *robot::Model::make(name, links, joints);
  }
};

/// base - a1 - a2 - ... - a<n>, with group "arm", its state "ready" and disabled neighbours.
inline world::RobotSpec serial_robot(const std::string& name, int joints) {
  Tree tree;
  int last = tree.add("base");
  for (int i = 1; i <= joints; ++i) last = tree.add(numbered("a", i), last);
  world::RobotSpec robot;
  robot.name = name;
  robot.model = tree.make();
  robot::Group group{"arm", {}, last};
  robot::NamedState ready{"ready", "arm", {}};
  for (int i = 0; i < joints; ++i) {
    group.joints.push_back(i);
    ready.values[numbered("to_a", i + 1)] = 0.1 * (i + 1);
    robot.semantics.disabled_pairs.push_back(
        {i == 0 ? "base" : numbered("a", i), numbered("a", i + 1), "Adjacent"});
  }
  robot.semantics.groups.push_back(group);
  robot.semantics.states.push_back(ready);
  return robot;
}

inline world::ArmSpec arm_spec(const std::string& name, const std::string& robot,
                               const std::string& group) {
  world::ArmSpec arm;
  arm.name = name;
  arm.robot = robot;
  arm.group = group;
  return arm;
}

/// Robots "left" and "right" of three joints, an obstacle "table".
inline world::WorkcellSpec two_arms() {
  world::WorkcellSpec spec;
  spec.name = "two";
  for (const char* name : {"left", "right"}) {
    spec.robots.push_back(serial_robot(name, 3));
    spec.arms.push_back(arm_spec(name, name, "arm"));
  }
  spec.robots[1].X_WB.translation() = Eigen::Vector3d(0, 2, 0);
  spec.obstacles.push_back({"table", {ball(), ball()}});
  return spec;
}

inline std::shared_ptr<const world::Workcell> make_cell(world::WorkcellSpec spec) {
  auto cell = world::Workcell::make(std::move(spec));
  EXPECT_TRUE(cell) << (cell ? "" : cell.error().message);
  return cell ? *cell : nullptr;
}

/// The reason why the pair is skipped, "checked" if it is not, "unknown" if a name is.
inline std::string pair_state(const world::Workcell& cell, const std::string& name_a,
                              const std::string& name_b) {
  const int i = cell.find_body(name_a), j = cell.find_body(name_b);
  if (i < 0 || j < 0) return "unknown";
  const int a = std::min(i, j), b = std::max(i, j);
  for (const world::BodyPair& pair : cell.pairs()) {
    if (pair.a == a && pair.b == b) return "checked";
  }
  for (const world::SkippedPair& pair : cell.skipped_pairs()) {
    if (pair.a == a && pair.b == b) return pair.reason;
  }
  return "lost";
}

}  // namespace tandem::test
