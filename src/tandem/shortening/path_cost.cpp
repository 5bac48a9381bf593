#include "tandem/shortening/path_cost.h"

#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/math/so3.h"

namespace tandem::shortening {

using Eigen::VectorXd;

PathCost::PathCost(const world::Workcell& cell, const Weights& weights)
    : cell_(cell), joints_(weights.joints) {
  expects(weights.arms.empty() || weights.arms.size() == cell.arms().size(),
          "one weight per arm, or none");
  expects(weights.translation >= 0 && weights.rotation >= 0 && weights.joints >= 0,
          "weights are not negative");
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    const double weight = weights.arms.empty() ? 1.0 : weights.arms[i];
    expects(weight >= 0, "weights are not negative");
    translation_.push_back(std::sqrt(weight * weights.translation));
    rotation_.push_back(std::sqrt(weight * weights.rotation));
  }
}

void PathCost::place(const Eigen::Ref<const VectorXd>& q, bool jacobians, Waypoint& waypoint) {
  waypoint.q = q;
  waypoint.tools.resize(cell_.arms().size());
  cell_.forward_kinematics(q, positions_, X_WL_);
  for (std::size_t i = 0; i < waypoint.tools.size(); ++i) {
    const world::Arm& arm = cell_.arms()[i];
    Waypoint::Tool& tool = waypoint.tools[i];
    const Eigen::Isometry3d X_WE = cell_.tool_pose(static_cast<int>(i), X_WL_);
    tool.p_WE = X_WE.translation();
    tool.Q_WE = Eigen::Quaterniond(Eigen::Matrix3d(X_WE.linear()));
    if (!jacobians) continue;
    tool.J_WE.resize(6, arm.dof());
    robot::jacobian(cell_.model(), X_WL_, arm.tip_link, tool.p_WE, arm.columns, tool.J_WE);
  }
}

PathCost::Vector6d PathCost::residual(const Waypoint& from, const Waypoint& to,
                                      std::size_t arm) const {
  const Waypoint::Tool &a = from.tools[arm], &b = to.tools[arm];
  Vector6d r;
  r.head<3>() = translation_[arm] * (b.p_WE - a.p_WE);
  r.tail<3>() = rotation_[arm] * math::log_map(a.Q_WE.conjugate() * b.Q_WE);
  return r;
}

PathCost::Vector6d PathCost::linearise(const Waypoint& from, const Waypoint& to, std::size_t arm) {
  const Waypoint::Tool &a = from.tools[arm], &b = to.tools[arm];
  const Eigen::Vector3d p = math::log_map(a.Q_WE.conjugate() * b.Q_WE);
  Vector6d r;
  r.head<3>() = translation_[arm] * (b.p_WE - a.p_WE);
  r.tail<3>() = rotation_[arm] * p;
  J_from_.resize(6, a.J_WE.cols());
  J_to_.resize(6, b.J_WE.cols());
  J_from_.topRows<3>() = -translation_[arm] * a.J_WE.topRows<3>();
  J_to_.topRows<3>() = translation_[arm] * b.J_WE.topRows<3>();
  const Eigen::Matrix3d to_rate =
      rotation_[arm] * math::log_map_jacobian(p) * a.Q_WE.conjugate().toRotationMatrix();
  const Eigen::Matrix3d from_rate =
      -rotation_[arm] * math::log_map_jacobian(-p) * b.Q_WE.conjugate().toRotationMatrix();
  J_to_.bottomRows<3>().noalias() = to_rate * b.J_WE.bottomRows<3>();
  J_from_.bottomRows<3>().noalias() = from_rate * a.J_WE.bottomRows<3>();
  return r;
}

double PathCost::squared_length(const Waypoint& from, const Waypoint& to) const {
  double sum = 0;
  for (std::size_t i = 0; i < cell_.arms().size(); ++i) sum += residual(from, to, i).squaredNorm();
  return sum;
}

double PathCost::edge(const Waypoint& from, const Waypoint& to) const {
  return 0.5 * (squared_length(from, to) + joints_ * (to.q - from.q).squaredNorm());
}

double PathCost::path(const motion::JointPath& path) {
  double sum = 0;
  Waypoint from, to;
  place(path.front(), false, from);
  for (std::size_t i = 1; i < path.size(); ++i) {
    place(path[i], false, to);
    sum += edge(from, to);
    std::swap(from, to);
  }
  return sum;
}

void PathCost::add_derivatives(const Waypoint& from, const Waypoint& to, double scale, int block,
                               VectorXd& gradient, math::BlockTridiagonal* H) {
  const Eigen::Index dof = cell_.dof();
  const auto count = static_cast<int>(gradient.size() / dof);
  const bool has_from = block >= 0, has_to = block + 1 < count;
  for (std::size_t i = 0; i < cell_.arms().size(); ++i) {
    const world::Arm& arm = cell_.arms()[i];
    const Vector6d r = scale * linearise(from, to, i);
    const Eigen::Index at = arm.offset, n = arm.dof();
    if (has_from) gradient.segment(block * dof + at, n) += J_from_.transpose() * r;
    if (has_to) gradient.segment((block + 1) * dof + at, n) += J_to_.transpose() * r;
    if (!H) continue;
    if (has_from) {
      H->diagonal(block).block(at, at, n, n) += scale * (J_from_.transpose() * J_from_).eval();
    }
    if (has_to) {
      H->diagonal(block + 1).block(at, at, n, n) += scale * (J_to_.transpose() * J_to_).eval();
    }
    if (has_from && has_to) {
      H->lower(block).block(at, at, n, n) += scale * (J_to_.transpose() * J_from_).eval();
    }
  }
  const double joints = scale * joints_;
  if (has_from) {
    gradient.segment(block * dof, dof) -= joints * (to.q - from.q);
    if (H) H->diagonal(block).diagonal().array() += joints;
  }
  if (has_to) {
    gradient.segment((block + 1) * dof, dof) += joints * (to.q - from.q);
    if (H) H->diagonal(block + 1).diagonal().array() += joints;
  }
  if (H && has_from && has_to) H->lower(block).diagonal().array() -= joints;
}

void PathCost::length_gradient(const Waypoint& from, const Waypoint& to, VectorXd& at_from,
                               VectorXd& at_to) {
  at_from.setZero(cell_.dof());
  at_to.setZero(cell_.dof());
  for (std::size_t i = 0; i < cell_.arms().size(); ++i) {
    const world::Arm& arm = cell_.arms()[i];
    const Vector6d r = 2 * linearise(from, to, i);
    at_from.segment(arm.offset, arm.dof()) = J_from_.transpose() * r;
    at_to.segment(arm.offset, arm.dof()) = J_to_.transpose() * r;
  }
}

}  // namespace tandem::shortening
