#pragma once
/// Cells of sliding arms in which it is known what becomes of coordination.

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::test {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Shape;

/// A robot whose joints slide along `axes`; its last link carries `load`.
inline world::RobotSpec sliding_robot(const std::string& name, const std::vector<Vector3d>& axes,
                                      double reach, std::vector<Shape> load) {
  std::vector<robot::Link> links(axes.size() + 1);
  std::vector<robot::Joint> joints(axes.size());
  for (std::size_t i = 0; i < links.size(); ++i) links[i].name = "link" + std::to_string(i);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    robot::Joint& joint = joints[i];
    joint.name = "slide" + std::to_string(i);
    joint.type = robot::JointType::kPrismatic;
    joint.axis_J = axes[i];
    joint.parent_link = static_cast<int>(i);
    joint.child_link = static_cast<int>(i) + 1;
    joint.limits = {-reach, reach, 1, 4, std::numeric_limits<double>::infinity()};
  }
  world::RobotSpec robot;
  robot.name = name;
  robot.model = *robot::Model::make(name, links, joints);
  robot.volumes[links.back().name] = std::move(load);
  return robot;
}

/// Ends of one arm.
struct Way {
  Eigen::VectorXd start, goal;
};

/// A cell of `robots`, one arm each, with the query "go".
inline std::shared_ptr<const world::Workcell> gallery_cell(std::vector<world::RobotSpec> robots,
                                                           const std::vector<Way>& ways,
                                                           std::vector<Shape> walls = {}) {
  world::WorkcellSpec spec;
  spec.name = "gallery";
  world::QuerySpec query{"go", {}, {}};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    world::ArmSpec arm;
    arm.name = arm.robot = robots[i].name;
    arm.base = robots[i].model.links().front().name;
    arm.tip = robots[i].model.links().back().name;
    spec.arms.push_back(arm);
    query.start[arm.name] = world::JointGoal{ways[i].start};
    query.goal[arm.name] = world::JointGoal{ways[i].goal};
  }
  spec.robots = std::move(robots);
  if (!walls.empty()) spec.obstacles.push_back({"walls", std::move(walls)});
  spec.queries = {query};
  auto cell = world::Workcell::make(std::move(spec));
  EXPECT_TRUE(cell) << (cell ? "" : cell.error().message);
  return cell ? *cell : nullptr;
}

inline Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

constexpr double kStencilRadius = 0.1;

/// A part of a coordination diagram that shall be blocked: what is within kStencilRadius of the
/// straight line between two points (position of a, position of b).
struct Blocked {
  Vector2d from, to;
};

/// Arms "a" and "b" slide from 0 to 1, a along x, b along y. What b carries makes any diagram:
/// where it has a capsule from (x, -y), a at x and b at y touch.
inline std::shared_ptr<const world::Workcell> stencil_cell(const std::vector<Blocked>& diagram) {
  constexpr double kOwn = 0.02;
  const auto at = [](const Vector2d& place) { return Vector3d(place.x(), -place.y(), 0); };
  std::vector<Shape> stencil;
  for (const Blocked& part : diagram) {
    stencil.push_back(*Shape::capsule(at(part.from), at(part.to), kStencilRadius - kOwn));
  }
  return gallery_cell(
      {sliding_robot("a", {Vector3d::UnitX()}, 2, {*Shape::sphere(Vector3d::Zero(), kOwn)}),
       sliding_robot("b", {Vector3d::UnitY()}, 2, stencil)},
      {{one(0), one(1)}, {one(0), one(1)}});
}

constexpr double kDisc = 0.1;  ///< Radius of what discs are.

/// Two balls that slide in the plane of `walls`.
inline std::shared_ptr<const world::Workcell> disc_cell(const Way& a, const Way& b,
                                                        std::vector<Shape> walls) {
  const std::vector<Vector3d> axes = {Vector3d::UnitX(), Vector3d::UnitY()};
  const Shape ball = *Shape::sphere(Vector3d::Zero(), kDisc);
  return gallery_cell(
      {sliding_robot("a", axes, 1.5, {ball}), sliding_robot("b", axes, 1.5, {ball})}, {a, b},
      std::move(walls));
}

/// A wall between two corners of the plane.
inline Shape wall(double x0, double y0, double x1, double y1) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Vector3d((x0 + x1) / 2, (y0 + y1) / 2, 0);
  return *Shape::box(X, {x1 - x0, y1 - y0, 0.4});
}

/// A corridor along x from -1.2 to 1.2 too narrow for two, 0.3 wide around y = 0, with a bay above
/// its middle.
inline std::vector<Shape> corridor_with_bay() {
  return {wall(-1.4, -0.25, 1.4, -0.15), wall(-1.4, 0.15, -0.2, 0.25), wall(0.2, 0.15, 1.4, 0.25),
          wall(-0.3, 0.25, -0.2, 0.6),   wall(0.2, 0.25, 0.3, 0.6),    wall(-0.3, 0.6, 0.3, 0.7),
          wall(-1.5, -0.25, -1.4, 0.25), wall(1.4, -0.25, 1.5, 0.25)};
}

/// A way around an island, 0.3 wide: one of two arms can go above it and the other below.
inline std::vector<Shape> ring() {
  return {wall(-0.4, -0.3, 0.4, 0.3), wall(-0.9, 0.6, 0.9, 0.7), wall(-0.9, -0.7, 0.9, -0.6),
          wall(-0.8, -0.6, -0.7, 0.6), wall(0.7, -0.6, 0.8, 0.6)};
}

}  // namespace tandem::test
