#pragma once
/// Private to this folder: what one joint does, shared by kinematics and inverse kinematics.

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "tandem/robot/kinematics.h"

namespace tandem::robot {

/// The position entry that drives a movable joint: its own, or that of the joint it follows.
inline int driving_position(const std::vector<Joint>& joints, const Joint& joint) {
  if (!joint.mimic) return joint.position_index;
  return joints[static_cast<std::size_t>(joint.mimic->joint)].position_index;
}

/// Value of a joint [rad or m]; 0 for a fixed one.
inline double joint_value(const std::vector<Joint>& joints, const Joint& joint,
                          const Eigen::Ref<const Eigen::VectorXd>& positions) {
  if (joint.type == JointType::kFixed) return 0;
  const double q = positions[driving_position(joints, joint)];
  return joint.mimic ? joint.mimic->multiplier * q + joint.mimic->offset : q;
}

/// R <- R * Rot(axis, angle). Nearly every axis is a coordinate axis, where two columns mix.
inline void rotate_about(const Eigen::Vector3d& axis, double angle,
                         Eigen::Ref<Eigen::Matrix3d, 0, Eigen::OuterStride<>> R) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) != 1.0) continue;
    const int u = (i + 1) % 3, v = (i + 2) % 3;
    const double c = std::cos(angle), s = axis[i] * std::sin(angle);
    const Eigen::Vector3d R_u = R.col(u);
    R.col(u) = c * R_u + s * R.col(v);
    R.col(v) = c * R.col(v) - s * R_u;
    return;
  }
  R = R * Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// Pose of the joint's child link from that of its parent.
inline void place_child(const Joint& joint, double value, LinkPoses& X_WL) {
  const Eigen::Isometry3d& X_WP = X_WL[static_cast<std::size_t>(joint.parent_link)];
  Eigen::Isometry3d& X_WC = X_WL[static_cast<std::size_t>(joint.child_link)];
  X_WC.linear().noalias() = X_WP.linear() * joint.X_PJ.linear();
  X_WC.translation() = X_WP.linear() * joint.X_PJ.translation() + X_WP.translation();
  switch (joint.type) {
    case JointType::kFixed:
      return;
    case JointType::kPrismatic:
      X_WC.translation() += X_WC.linear() * (value * joint.axis_J);
      return;
    case JointType::kRevolute:
    case JointType::kContinuous:
      rotate_about(joint.axis_J, value, X_WC.linear());
      return;
  }
}

/// Adds to `column` (linear, angular; in W) what a unit rate of the joint's driving position does
/// to point P fixed below it. The axis is the same in the joint's and the child's frame.
inline void add_joint_column(const Joint& joint, const Eigen::Isometry3d& X_WC,
                             const Eigen::Vector3d& p_WP,
                             Eigen::Ref<Eigen::Matrix<double, 6, 1>> column) {
  const double gain = joint.mimic ? joint.mimic->multiplier : 1.0;
  const Eigen::Vector3d axis_W = gain * (X_WC.linear() * joint.axis_J);
  if (joint.type == JointType::kPrismatic) {
    column.head<3>() += axis_W;
  } else {
    column.head<3>() += axis_W.cross(p_WP - X_WC.translation());
    column.tail<3>() += axis_W;
  }
}

}  // namespace tandem::robot
