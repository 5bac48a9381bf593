#pragma once
/// Private to this folder: what the exact and the batch form of a cell compile joints with.

#include <Eigen/Geometry>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::collision {

/// A link's place in the compiled tree.
struct LinkFrame {
  int joint = -1;
  Eigen::Isometry3d X_JL = Eigen::Isometry3d::Identity();
};

/// What a joint at `value` does to what it carries, in its own frame.
inline Eigen::Isometry3d joint_motion(const robot::Joint& joint, double value) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (joint.type == robot::JointType::kPrismatic) {
    X.translation() = value * joint.axis_J;
  } else if (joint.type != robot::JointType::kFixed) {
    X.linear() = Eigen::AngleAxisd(value, joint.axis_J).toRotationMatrix();
  }
  return X;
}

/// Which entry of q stands behind each entry of a position vector, or -1.
inline std::vector<int> columns_of_positions(const world::Workcell& cell) {
  std::vector<int> columns(static_cast<std::size_t>(cell.model().position_count()), -1);
  for (const world::Arm& arm : cell.arms()) {
    for (int k = 0; k < arm.dof(); ++k) {
      columns[static_cast<std::size_t>(arm.columns[static_cast<std::size_t>(k)])] = arm.offset + k;
    }
  }
  return columns;
}

}  // namespace tandem::collision
