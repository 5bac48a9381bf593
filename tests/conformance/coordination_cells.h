#pragma once
/// Cells and motions for coordination whose collisions are known by hand: discs in a plane.

#include <gtest/gtest.h>

#include <optional>

#include "small_cell.h"
#include "tandem/coordination/coordinator.h"
#include "tandem/core/rng.h"
#include "tandem/motion/cell_motion.h"
#include "tandem/motion/joint_path.h"

namespace tandem::coordination::test {

using Eigen::Vector2d, Eigen::VectorXd;

/// An arm of two prismatic joints that carries a ball in the plane z = 0.
inline world::RobotSpec disc_robot(const std::string& name, double radius) {
  std::vector<robot::Link> links(3);
  std::vector<robot::Joint> joints(2);
  for (int i = 0; i < 3; ++i)
    links[static_cast<std::size_t>(i)].name = i == 2 ? "disc" : "base" + std::to_string(i);
  for (int i = 0; i < 2; ++i) {
    robot::Joint& joint = joints[static_cast<std::size_t>(i)];
    joint.name = i == 0 ? "x" : "y";
    joint.type = robot::JointType::kPrismatic;
    joint.parent_link = i;
    joint.child_link = i + 1;
    joint.axis_J = i == 0 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    joint.limits = {-10.0, 10.0, 2.0, 10.0};
  }
  world::RobotSpec robot;
  robot.name = name;
  robot.model = *robot::Model::make("slider", links, joints);
  robot.semantics.groups = {robot::Group{"arm", {0, 1}, 2}};
  robot.volumes["disc"] = {*geometry::Shape::sphere(Eigen::Vector3d::Zero(), radius)};
  return robot;
}

/// Discs "a", "b", ... of these radii; joint values are their positions [m].
inline std::shared_ptr<const world::Workcell> disc_cell(const std::vector<double>& radii) {
  world::WorkcellSpec spec;
  spec.name = "discs";
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const std::string name(1, static_cast<char>('a' + i));
    spec.robots.push_back(disc_robot(name, radii[i]));
    world::ArmSpec arm;
    arm.name = arm.robot = name;
    arm.group = "arm";
    spec.arms.push_back(arm);
  }
  auto cell = world::Workcell::make(std::move(spec));
  if (!cell) throw std::runtime_error(cell.error().message);
  return *cell;
}

/// Through the waypoints, at rest in each: the cubic of each edge takes `seconds`.
inline motion::PiecewiseCubic rest_to_rest(const motion::JointPath& path, double seconds) {
  std::vector<double> knots{0.0};
  std::vector<motion::PiecewiseCubic::Coefficients> segments;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const VectorXd d = path[k] - path[k - 1];
    motion::PiecewiseCubic::Coefficients c(d.size(), 4);
    c << path[k - 1], VectorXd::Zero(d.size()), 3 * d / (seconds * seconds),
        -2 * d / (seconds * seconds * seconds);
    knots.push_back(knots.back() + seconds);
    segments.push_back(c);
  }
  return *motion::PiecewiseCubic::make(std::move(knots), std::move(segments));
}

/// A cell with motions, and what is known of it.
struct CoordinationCase {
  std::string name;
  std::shared_ptr<const collision::CompiledCell> compiled;
  const collision::SsvChecker* checker = nullptr;  ///< compiled->exact().
  std::vector<motion::PiecewiseCubic> arms;
  bool goes_back = false;   ///< Only with an arm that goes back.
  bool deadlocks = false;   ///< There is no schedule.
  bool in_sequence = true;  ///< Some order of one after the other is free.

  CoordinationProblem problem() const { return {*compiled, arms}; }
  void set_cell(std::shared_ptr<const world::Workcell> cell) {
    compiled = std::make_shared<const collision::CompiledCell>(std::move(cell));
    checker = &compiled->exact();
  }
};

inline void PrintTo(const CoordinationCase& c, std::ostream* out) { *out << c.name; }

/// Discs of radius 0.1 along polylines, `seconds` per edge.
inline CoordinationCase disc_case(const std::string& name,
                                  const std::vector<std::vector<Vector2d>>& paths,
                                  double seconds = 1.0) {
  CoordinationCase c;
  c.name = name;
  c.set_cell(disc_cell(std::vector<double>(paths.size(), 0.1)));
  for (const auto& path : paths) {
    c.arms.push_back(rest_to_rest(motion::JointPath(path.begin(), path.end()), seconds));
  }
  return c;
}

/// Two paths that cross in the middle, at the same time.
inline CoordinationCase crossing() {
  return disc_case("crossing", {{{-1, 0}, {1, 0}}, {{0, -1}, {0, 1}}});
}
/// Side by side, never near each other, of different durations.
inline CoordinationCase apart() {
  return disc_case("apart", {{{-1, 0}, {1, 0}}, {{-1, 1}, {0, 1}, {1, 1}}});
}
/// Head on in a corridor: whoever goes first, they meet.
inline CoordinationCase head_on() {
  auto c = disc_case("head_on", {{{-1, 0}, {1, 0}}, {{1, 0}, {-1, 0}}});
  c.deadlocks = true;
  c.in_sequence = false;
  return c;
}
/// "a" passes through a corridor twice and turns aside between; "b" comes the other way. So that
/// "b" can pass, "a" must be aside, where it is only after half of its motion.
inline CoordinationCase siding() {
  auto c = disc_case("siding", {{{-1, 0}, {0, 0}, {0, 1}, {0, 0}, {1, 0}}, {{0.6, 0}, {-2, 0}}});
  c.in_sequence = false;
  return c;
}
/// "b" crosses the short way of "a" near its start and then near its end; each place of "a" is in
/// the way of one of them, so that "a" lets "b" pass at its end and then goes back.
inline CoordinationCase back_and_forth() {
  auto c = disc_case("back_and_forth",
                     {{{0, 0}, {0.3, 0}}, {{-0.04, -1}, {-0.04, 1}, {0.34, 1}, {0.34, -1}}});
  c.goes_back = true;
  c.in_sequence = false;
  return c;
}
inline CoordinationCase three_cross() {
  return disc_case("three_cross",
                   {{{-1, 0}, {1, 0}}, {{0, -1}, {0, 1}}, {{-0.7, 0.7}, {0.7, -0.7}}});
}
inline CoordinationCase four_cross() {
  return disc_case("four_cross", {{{-1, 0}, {1, 0}},
                                  {{0, -1}, {0, 1}},
                                  {{-0.7, 0.7}, {0.7, -0.7}},
                                  {{0.7, 0.7}, {-0.7, -0.7}}});
}

inline std::vector<CoordinationCase> disc_cases() {
  return {apart(), crossing(), head_on(), siding(), back_and_forth(), three_cross(), four_cross()};
}

/// Two real arms that swing past each other on two random edges each; nothing if one of them is not
/// free alone, or the ends together are not.
inline std::optional<CoordinationCase> swinging_arms(std::uint64_t seed) {
  const auto cell = tandem::test::small_cell();
  CoordinationCase c;
  c.name = "swinging_" + std::to_string(seed);
  c.set_cell(cell);
  const auto scratch = c.checker->make_scratch();
  Rng rng(seed);
  for (const world::Arm& arm : cell->arms()) {
    motion::JointPath path;
    for (int k = 0; k < 3; ++k) {
      path.push_back(Eigen::Vector4d(rng.uniform(-1.4, 1.4), rng.uniform(-0.6, 0.1),
                                     rng.uniform(-0.3, 0.6), rng.uniform(-2, 2)));
    }
    c.arms.push_back(rest_to_rest(path, rng.uniform(0.6, 1.5)));
    const auto i = static_cast<int>(c.arms.size()) - 1;
    // Alone: the others stand anywhere, their pairs are not asked about.
    std::vector<motion::ArmMotion> all;
    for (const world::Arm& other : cell->arms()) {
      all.push_back(other.offset == arm.offset
                        ? c.arms.back()
                        : rest_to_rest({VectorXd::Zero(other.dof()), VectorXd::Zero(other.dof())},
                                       c.arms.back().duration()));
    }
    const auto alone = cell->select(world::PairScope::arm(i));
    if (!collision::certify(*c.checker, motion::CellMotion(all), alone, *scratch).is_free()) {
      return std::nullopt;
    }
  }
  if (!check_problem(c.problem(), *scratch)) return std::nullopt;
  return c;
}

}  // namespace tandem::coordination::test
