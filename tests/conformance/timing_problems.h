#pragma once
/// Random paths and limits for tests of time optimisers.

#include <cmath>
#include <numbers>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/motion/joint_path.h"
#include "tandem/robot/model.h"

namespace tandem::test {

/// Two Pandas: velocity and acceleration as MoveIt has them, jerk a hundredth of the hardware's.
inline std::vector<robot::JointLimits> two_panda_limits(bool with_jerk) {
  constexpr double kVelocity[] = {2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61};
  constexpr double kAcceleration[] = {3.75, 1.875, 2.5, 3.125, 3.75, 5.0, 5.0};
  std::vector<robot::JointLimits> limits(14);
  for (std::size_t j = 0; j < limits.size(); ++j) {
    limits[j].velocity = kVelocity[j % 7];
    limits[j].acceleration = kAcceleration[j % 7];
    if (with_jerk) limits[j].jerk = 20 * limits[j].acceleration;
  }
  return limits;
}

enum class PathKind {
  kZigzag,  ///< Independent steps of up to a radian per joint, as a raw planner leaves them.
  kMixed,   ///< Edges from 1e-6 to 2 rad in one path.
  kSmooth,  ///< A bent line, as a post-processor leaves it.
  kStill,   ///< A zigzag in which a random half of the joints does not move.
};

inline motion::JointPath random_path(Rng& rng, PathKind kind, int count, int dof) {
  using Eigen::VectorXd;
  const auto random = [&](double size) {
    return VectorXd(VectorXd::NullaryExpr(dof, [&] { return rng.uniform(-size, size); }));
  };
  motion::JointPath path{random(2)};
  if (kind == PathKind::kSmooth) {
    const VectorXd start = path[0], goal = random(2), bend = random(0.5);
    for (int i = 1; i < count; ++i) {
      const double s = static_cast<double>(i) / (count - 1);
      path.push_back(start + s * (goal - start) + std::sin(std::numbers::pi * s) * bend);
    }
    return path;
  }
  VectorXd moves = VectorXd::Ones(dof);
  if (kind == PathKind::kStill) {
    for (int j = 1; j < dof; ++j) moves[j] = static_cast<double>(rng.index(2));
  }
  for (int i = 1; i < count; ++i) {
    const double size = kind == PathKind::kMixed ? std::pow(10, rng.uniform(-6, 0.3)) : 1.0;
    path.push_back(path.back() + random(size).cwiseProduct(moves));
  }
  return path;
}

inline constexpr PathKind kPathKinds[] = {PathKind::kZigzag, PathKind::kMixed, PathKind::kSmooth,
                                          PathKind::kStill};

}  // namespace tandem::test
