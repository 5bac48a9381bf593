#pragma once
/// Two small arms over a table with a thin wall between them, built in memory for tests.

#include <memory>
#include <string>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::test {

/// A four-joint arm: yaw, two pitches and a wrist yaw; capsule links of 0.35, 0.3 and 0.15 m.
inline robot::Model small_arm() {
  const double lengths[] = {0.1, 0.35, 0.3, 0.15};
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(),
                                  Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  std::vector<robot::Link> links(1);
  links[0].name = "base";
  std::vector<robot::Joint> joints;
  for (int i = 0; i < 4; ++i) {
    robot::Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.type = robot::JointType::kRevolute;
    joint.parent_link = i;
    joint.child_link = i + 1;
    joint.axis_J = axes[i];
    if (i == 1) joint.X_PJ.translation().z() = lengths[0];
    if (i > 1) joint.X_PJ.translation().x() = lengths[i - 1];
    joint.limits = {-2.5, 2.5, 2.0, 4.0, std::numeric_limits<double>::infinity()};
    joints.push_back(joint);
    robot::Link link;
    link.name = "link" + std::to_string(i + 1);
    links.push_back(link);
  }
  return *robot::Model::make("small_arm", links, joints);
}

inline world::RobotSpec small_robot(const std::string& name, const Eigen::Isometry3d& X_WB) {
  world::RobotSpec spec;
  spec.name = name;
  spec.model = small_arm();
  spec.X_WB = X_WB;
  robot::Group group;
  group.name = "arm";
  for (int i = 0; i < 4; ++i) {
    group.joints.push_back(spec.model.find_joint("joint" + std::to_string(i + 1)));
  }
  group.tip_link = spec.model.find_link("link4");
  spec.semantics.groups = {group};
  spec.semantics.states = {
      {"up", "arm", {{"joint1", 0.0}, {"joint2", -1.4}, {"joint3", 0.5}, {"joint4", 0.0}}}};
  for (const auto& [a, b] : {std::pair{"link1", "link2"}, {"link2", "link3"}, {"link3", "link4"}}) {
    spec.semantics.disabled_pairs.push_back({a, b, "Adjacent"});
  }
  const Eigen::Vector3d o = Eigen::Vector3d::Zero(), x = Eigen::Vector3d::UnitX();
  const auto capsule = [&](double length, double radius) {
    return std::vector{*geometry::Shape::capsule(o, length * x, radius)};
  };
  spec.volumes["link1"] = {*geometry::Shape::sphere(o, 0.05)};
  spec.volumes["link2"] = capsule(0.35, 0.04);
  spec.volumes["link3"] = capsule(0.3, 0.035);
  spec.volumes["link4"] = capsule(0.15, 0.02);
  return spec;
}

/// Arms "left" and "right" face each other 1 m apart; queries "cross" and "back".
inline world::WorkcellSpec small_cell_spec() {
  world::WorkcellSpec spec;
  spec.name = "small";
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = Eigen::Vector3d(-0.5, 0, 0.1);
  spec.robots.push_back(small_robot("left", X_WB));
  X_WB.translation().x() = 0.5;
  X_WB.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  spec.robots.push_back(small_robot("right", X_WB));
  for (const char* name : {"left", "right"}) spec.arms.push_back({name, name, "arm", "", {}});
  for (auto& arm : spec.arms) {
    arm.X_LE = Eigen::Isometry3d::Identity();
    arm.X_LE.translation().x() = 0.15;
  }
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  X_WO.translation().z() = -0.03;
  spec.obstacles.push_back({"table", {*geometry::Shape::box(X_WO, {2, 2, 0.06})}});
  X_WO.translation() = Eigen::Vector3d(0, 0.25, 0.15);
  spec.obstacles.push_back({"wall", {*geometry::Shape::box(X_WO, {0.3, 0.005, 0.3})}});
  const auto goal = [](double a, double b, double c, double d) {
    return world::ArmGoal(world::JointGoal{Eigen::Vector4d(a, b, c, d)});
  };
  spec.queries = {
      {"cross",
       {{"left", goal(1.0, -0.2, 0.3, 0)}, {"right", goal(0.9, -0.3, 0.4, 0)}},
       {{"left", goal(-0.8, -0.2, 0.3, 0)}, {"right", goal(-0.9, -0.3, 0.4, 0)}}},
      {"back", {}, {{"left", world::StateGoal{"up"}}, {"right", world::StateGoal{"up"}}}}};
  return spec;
}

inline std::shared_ptr<const world::Workcell> small_cell() {
  auto cell = world::Workcell::make(small_cell_spec());
  if (!cell) throw std::runtime_error(cell.error().message);
  return *cell;
}

}  // namespace tandem::test
