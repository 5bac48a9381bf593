#pragma once
/// Maps of SO(3) and their Jacobians.

#include <Eigen/Geometry>

namespace tandem::math {

/// Rotation vector of a unit quaternion, |p| <= pi: the shortest of the two arcs.
/// Ref: the paper, eq:Log; computed as 2 atan2(|v|, w) / |v|, with its series near zero.
Eigen::Vector3d log_map(const Eigen::Quaterniond& u);

/// Unit quaternion of a rotation vector [rad].
Eigen::Quaterniond exp_map(const Eigen::Vector3d& p);

/// Jacobian of the logarithm: dp = T^-1(p) xi for a rotation rate xi expressed in the frame that
/// the rotation starts from; T^-1(-p) takes xi in the moved frame. Regular for |p| < 2 pi. Ref:
/// eq:ExpJac, with a series near zero.
Eigen::Matrix3d log_map_jacobian(const Eigen::Vector3d& p);

}  // namespace tandem::math
