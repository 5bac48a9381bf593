#pragma once
/// Random two-arm cells with every kind of joint and shape, for tests of collision checks.

#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/random_surface.h"
#include "tandem/core/rng.h"
#include "tandem/world/workcell.h"

namespace tandem::test {

using geometry::CoreType;
using geometry::Shape;

inline Eigen::Vector3d random_point(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

inline Eigen::Matrix3d random_rotation(Rng& rng) {
  const Eigen::Vector3d axis = random_point(rng, 1).normalized();
  return Eigen::AngleAxisd(rng.uniform(-3, 3), axis).toRotationMatrix();
}

inline Eigen::Isometry3d random_pose(Rng& rng, double size) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = random_rotation(rng);
  X.translation() = random_point(rng, size);
  return X;
}

/// A shape of about `size` [m] near the origin of its frame.
inline Shape random_shape(Rng& rng, CoreType type, double size, double radius) {
  const auto extent = [&] { return rng.uniform(0.4, 1.0) * size; };
  const Eigen::Isometry3d X = random_pose(rng, 0.3 * size);
  const Eigen::Vector3d p = random_point(rng, size), q = random_point(rng, size);
  switch (type) {
    case CoreType::kPoint:
      return *Shape::sphere(X.translation(), radius);
    case CoreType::kSegment:
      return *Shape::capsule(p, q, radius);
    case CoreType::kTriangle:
      return *Shape::rounded_triangle(p, q, random_point(rng, size), radius);
    case CoreType::kRectangle:
      return *Shape::rounded_rectangle(X, {extent(), extent()}, radius);
    case CoreType::kBox:
      return *Shape::box(X, {extent(), extent(), extent()}, rng.index(2) == 0 ? 0.0 : radius);
    case CoreType::kCylinder:
      return *Shape::cylinder(X, 0.5 * extent(), extent(), rng.index(2) == 0 ? 0.0 : radius);
    case CoreType::kConvex: {
      std::vector<Eigen::Vector3d> points(12);
      for (Eigen::Vector3d& v : points) v = X * random_point(rng, 0.5 * size);
      return *Shape::convex(points, rng.index(2) == 0 ? 0.0 : radius);
    }
  }
  throw std::logic_error("no such core");
}

inline Shape random_shape(Rng& rng, double size, double radius) {
  return random_shape(rng, static_cast<CoreType>(rng.index(7)), size, radius);
}

/// A chain of `joints` joints of random kinds and axes; the last one's follower mimics it.
inline robot::Model random_arm(Rng& rng, int joints, bool prismatic) {
  using robot::JointType;
  std::vector<robot::Link> links(1);
  links[0].name = "link0";
  std::vector<robot::Joint> all;
  const auto add = [&](int parent, JointType type) -> robot::Joint& {
    robot::Joint joint;
    joint.name = "joint" + std::to_string(all.size() + 1);
    joint.type = type;
    joint.parent_link = parent;
    joint.child_link = static_cast<int>(links.size());
    joint.X_PJ = random_pose(rng, 0.05);
    joint.X_PJ.translation().z() += links.size() == 1 ? 0.0 : 0.2;
    joint.axis_J = rng.index(2) == 0 ? Eigen::Vector3d::Unit(static_cast<int>(rng.index(3)))
                                     : random_point(rng, 1).normalized();
    const double range = type == JointType::kPrismatic ? 0.2 : 2.5;
    joint.limits = {-range, range, 2.0, 10.0, std::numeric_limits<double>::infinity()};
    robot::Link link;
    link.name = "link" + std::to_string(links.size());
    links.push_back(link);
    all.push_back(joint);
    return all.back();
  };
  for (int i = 0; i < joints; ++i) {
    add(i, prismatic && rng.index(4) == 0 ? JointType::kPrismatic : JointType::kRevolute);
  }
  add(joints, JointType::kFixed);
  // A finger on the fixed hand follows the last joint; it opens the other way, half as far.
  add(joints + 1, all[static_cast<std::size_t>(joints - 1)].type).mimic =
      robot::Mimic{joints - 1, -0.5, 0.1};
  return *robot::Model::make("random_arm", links, all);
}

struct RandomCellOptions {
  int arms = 2;
  int joints = 5;
  int obstacles = 6;
  bool prismatic = true;
  double padding = 0.005;
  /// What links are made of; empty: everything.
  std::vector<CoreType> cores = {};
  /// Obstacles and tools are meshes and clouds too, of up to about so many pieces; 0: they are not.
  int surface_pieces = 0;
};

/// Out of the way of the first robot's base.
inline world::ObstacleSpec random_obstacle(Rng& rng, int i, const RandomCellOptions& o) {
  Eigen::Isometry3d X = random_pose(rng, 1.0);
  X.translation().x() += 0.4 * (o.arms - 1);
  if (X.translation().squaredNorm() < 0.2) X.translation().y() += 0.6;
  world::ObstacleSpec obstacle;
  obstacle.name = "obstacle" + std::to_string(i);
  if (o.surface_pieces == 0 || i % 3 == 0) {
    obstacle.shapes_W = {random_shape(rng, 0.3, 0.05).in(X)};
  }
  if (o.surface_pieces == 0) return obstacle;
  obstacle.surfaces_W = {{random_surface(rng, 0.25, o.surface_pieces), X}};
  // Large enough to hold a whole hand.
  if (i % 3 == 1) obstacle.surfaces_W.push_back({random_blob(rng, 6, 8, 0.6), X});
  return obstacle;
}

inline world::WorkcellSpec random_cell_spec(std::uint64_t seed, const RandomCellOptions& o = {}) {
  Rng rng(seed);
  const auto shape = [&](double size, double radius) {
    const CoreType type =
        o.cores.empty() ? static_cast<CoreType>(rng.index(7)) : o.cores[rng.index(o.cores.size())];
    return random_shape(rng, type, size, radius);
  };
  world::WorkcellSpec spec;
  spec.name = "random";
  spec.padding = o.padding;
  for (int i = 0; i < o.arms; ++i) {
    world::RobotSpec robot;
    robot.name = "r" + std::to_string(i);
    robot.model = random_arm(rng, o.joints, o.prismatic);
    robot.X_WB = random_pose(rng, 0.05);
    robot.X_WB.translation().x() += 0.8 * i;
    const auto& links = robot.model.links();
    for (std::size_t l = 0; l < links.size(); ++l) {
      auto& volumes = robot.volumes[links[l].name];
      volumes.push_back(shape(0.1, 0.04));
      if (l % 2 == 1) volumes.push_back(shape(0.1, 0.02));
    }
    for (std::size_t a = 0; a < links.size(); ++a) {
      for (std::size_t b = a + 1; b < std::min(a + 3, links.size()); ++b) {
        robot.semantics.disabled_pairs.push_back({links[a].name, links[b].name, "Adjacent"});
      }
    }
    spec.robots.push_back(std::move(robot));
    world::ArmSpec arm;
    arm.name = "arm" + std::to_string(i);
    arm.robot = spec.robots.back().name;
    arm.base = "link0";
    arm.tip = "link" + std::to_string(o.joints);
    spec.arms.push_back(arm);
    const std::string hand = arm.robot + "/link" + std::to_string(o.joints + 1);
    spec.attached.push_back({"tool" + std::to_string(i), hand, {shape(0.1, 0.02)}, {}, {}});
    if (o.surface_pieces > 0) {
      spec.attached.push_back({"carried" + std::to_string(i), hand, {}, {}, {}});
      spec.attached.back().surfaces_L = {
          {random_surface(rng, 0.06, o.surface_pieces / 8 + 12), random_pose(rng, 0.05)}};
    }
  }
  for (int i = 0; i < o.obstacles; ++i) spec.obstacles.push_back(random_obstacle(rng, i, o));
  return spec;
}

inline std::shared_ptr<const world::Workcell> make_cell(world::WorkcellSpec spec) {
  auto cell = world::Workcell::make(std::move(spec));
  if (!cell) throw std::runtime_error(cell.error().message);
  return *cell;
}

inline std::shared_ptr<const world::Workcell> random_cell(std::uint64_t seed,
                                                          const RandomCellOptions& o = {}) {
  return make_cell(random_cell_spec(seed, o));
}

/// An arm of one prismatic joint along x that carries a ball, and a ball to run into at x = 1.
inline world::WorkcellSpec slider_cell_spec(double padding = 0) {
  world::WorkcellSpec spec;
  spec.name = "slider";
  world::RobotSpec robot;
  robot.name = "slider";
  std::vector<robot::Link> links(2);
  links[0].name = "rail";
  links[1].name = "carriage";
  robot::Joint joint;
  joint.name = "slide";
  joint.type = robot::JointType::kPrismatic;
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.limits = {-1, 3, 1, 1, std::numeric_limits<double>::infinity()};
  robot.model = *robot::Model::make("slider", links, {joint});
  robot.volumes["carriage"] = {*geometry::Shape::sphere(Eigen::Vector3d::Zero(), 0.1)};
  spec.robots = {robot};
  world::ArmSpec arm;
  arm.name = "arm";
  arm.robot = "slider";
  arm.base = "rail";
  arm.tip = "carriage";
  spec.arms = {arm};
  world::ObstacleSpec ball;
  ball.name = "ball";
  ball.shapes_W = {*geometry::Shape::sphere(Eigen::Vector3d::UnitX(), 0.2)};
  spec.obstacles = {ball};
  spec.padding = padding;
  return spec;
}

inline std::shared_ptr<const world::Workcell> slider_cell(double padding = 0) {
  return make_cell(slider_cell_spec(padding));
}

/// Uniform inside the cell's limits, or inside the middle `part` of them.
inline Eigen::VectorXd random_configuration(Rng& rng, const world::Workcell& cell,
                                            double part = 1.0) {
  Eigen::VectorXd q(cell.dof());
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const double middle = 0.5 * (cell.lower()[j] + cell.upper()[j]);
    const double half = 0.5 * part * (cell.upper()[j] - cell.lower()[j]);
    q[j] = rng.uniform(middle - half, middle + half);
  }
  return q;
}

}  // namespace tandem::test
