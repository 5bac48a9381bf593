#pragma once
/// Forward kinematics and Jacobians of a model.

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "tandem/robot/model.h"

namespace tandem::robot {

using LinkPoses = std::vector<Eigen::Isometry3d>;  ///< X_WL by link index.

/// Poses of all links for `positions` (model.position_count()) [rad or m].
/// `X_WL` is resized on first use; no allocation after that.
void forward_kinematics(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& positions,
                        LinkPoses& X_WL);

/// Geometric Jacobian of point P fixed on `link`, for the position entries `columns`.
/// @param p_WP  the point, in W [m].
/// @param J_W   6 x columns.size(): linear rows of P, then angular rows, expressed in W.
/// Mimic joints add to the column of the joint they follow.
void jacobian(const Model& model, const LinkPoses& X_WL, int link, const Eigen::Vector3d& p_WP,
              std::span<const int> columns,
              Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> J_W);

}  // namespace tandem::robot
