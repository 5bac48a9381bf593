#include <cmath>

#include "tandem/collision/ssv_model.h"

namespace tandem::collision {

using Eigen::Vector3d;

SsvScratch::SsvScratch(const SsvModel& model)
    : model_(model),
      q_(Eigen::VectorXd::Zero(model.dof)),
      X_WJ_(model.joints.size(), Eigen::Isometry3d::Identity()),
      D_(model.joints.size()),
      chord_(model.joints.size()),
      turn_(model.joints.size()),
      travel_(model.nodes.size() * static_cast<std::size_t>(model.depth)),
      pose_time_(model.joints.size()),
      shape_time_(model.shapes.size()),
      travel_time_(model.nodes.size()) {
  for (const SsvNode& node : model.nodes) {
    p_WC_.push_back(node.p_JC);
    center_time_.push_back(node.joint < 0 ? kAlways : 0);
  }
  for (std::size_t s = 0; s < model.shapes.size(); ++s) {
    shape_W_.push_back(model.shapes[s].shape_J);
    shape_time_[s] = center_time_[model.bodies.size() + s];
  }
  certificate.q.resize(model.dof);
  certificate.D.resize(model.dof);
}

void SsvScratch::place(const Eigen::Ref<const Eigen::VectorXd>& q) {
  expects(q.size() == model_.dof, "q has one entry per joint of the cell's arms");
  expects(q.allFinite(), "q is finite");
  q_ = q;
  ++now_;
}

void SsvScratch::place_joint(std::size_t j) {
  const SsvJoint& joint = model_.joints[j];
  const double value = joint.multiplier * q_[joint.column] + joint.offset;
  Eigen::Isometry3d& X = X_WJ_[j];
  if (joint.parent < 0) {
    X = joint.X_PJ;
  } else {
    const Eigen::Isometry3d& X_WP = pose(joint.parent);
    X.translation().noalias() = X_WP.linear() * joint.X_PJ.translation();
    X.translation() += X_WP.translation();
    X.linear().noalias() = X_WP.linear() * joint.X_PJ.linear();
  }
  if (joint.prismatic) {
    X.translation() += value * X.linear().col(2);
  } else {
    const double c = std::cos(value), s = std::sin(value);
    const Vector3d x = X.linear().col(0), y = X.linear().col(1);
    X.linear().col(0) = c * x + s * y;
    X.linear().col(1) = c * y - s * x;
  }
  pose_time_[j] = now_;
}

void SsvScratch::place_node(std::size_t n) {
  const SsvNode& node = model_.nodes[n];
  const Eigen::Isometry3d& X_WJ = pose(node.joint);
  p_WC_[n].noalias() = X_WJ.linear() * node.p_JC;
  p_WC_[n] += X_WJ.translation();
  center_time_[n] = now_;
}

void SsvScratch::place_shape(std::size_t s) {
  shape_W_[s] = model_.shapes[s].shape_J.in(pose(model_.nodes[model_.bodies.size() + s].joint));
  shape_time_[s] = now_;
}

double SsvScratch::box_distance(int node, int shape) {
  const SsvShape& box = model_.shapes[static_cast<std::size_t>(shape)];
  const int joint = model_.nodes[static_cast<std::size_t>(model_.shape_node(shape))].joint;
  Vector3d p_J = center(node);
  if (joint >= 0) {
    const Eigen::Isometry3d& X_WJ = pose(joint);
    p_J = X_WJ.linear().transpose() * (p_J - X_WJ.translation());
  }
  const Vector3d p_B = box.R_BJ * (p_J - box.p_JBo);
  const Vector3d beyond = p_B.cwiseAbs() - box.half;
  const double deepest = beyond.maxCoeff();
  return (deepest > 0 ? beyond.cwiseMax(0.0).norm() : deepest) - box.shape_J.radius() -
         model_.nodes[static_cast<std::size_t>(node)].radius;
}

void SsvScratch::set_deviation(const Eigen::Ref<const Eigen::VectorXd>& D) {
  for (std::size_t j = 0; j < model_.joints.size(); ++j) {
    const SsvJoint& joint = model_.joints[j];
    const double above = joint.parent < 0 ? 0.0 : turn_[static_cast<std::size_t>(joint.parent)];
    D_[j] = std::abs(joint.multiplier) * D[joint.column];
    // However far a joint turns, nothing ends further away than the diameter of its circle.
    chord_[j] = joint.prismatic ? D_[j] : std::min(D_[j], 2.0);
    turn_[j] = above + (joint.prismatic ? 0.0 : D_[j]);
  }
}

// From q(m) to q(t) the joints are moved one after the other, base first. The distance of a point
// from the axis of joint j depends on the joints between them only, which still stand as at m: so
// j moves the point by at most the distance at m times |q_j(t) - q_j(m)|, without remainder.
void SsvScratch::bound_travel(std::size_t n) {
  const int last = model_.nodes[n].joint;
  const Vector3d p = center(static_cast<int>(n));
  double* row = &travel_[n * static_cast<std::size_t>(model_.depth)];
  double sum = 0;
  for (int j = last; j >= 0; j = model_.joints[static_cast<std::size_t>(j)].parent) {
    const auto i = static_cast<std::size_t>(j);
    const SsvJoint& joint = model_.joints[i];
    const Eigen::Isometry3d& X = X_WJ_[i];
    sum += joint.prismatic ? chord_[i]
                           : chord_[i] * X.linear().col(2).cross(p - X.translation()).norm();
    row[joint.depth - 1] = sum;
  }
  travel_time_[n] = now_;
}

// The same sequence of moves. Move j displaces the point by R * u, where u is the displacement by j
// alone, |u - J_j delta_j| <= D_j^2 / 2 * |J_j|, and R is the turn by the joints above, no further
// than the sum of their deviations.
double SsvScratch::travel_along(const Vector3d& n_W, int joint, int common, const Vector3d& p_WP) {
  const double turn_common = common < 0 ? 0.0 : turn_[static_cast<std::size_t>(common)];
  double sum = 0;
  for (int j = joint; j != common; j = model_.joints[static_cast<std::size_t>(j)].parent) {
    const auto i = static_cast<std::size_t>(j);
    const SsvJoint& moved = model_.joints[i];
    const Eigen::Isometry3d& X = X_WJ_[i];
    const Vector3d axis = X.linear().col(2);
    const double D = D_[i];
    if (moved.prismatic) {
      sum += D * std::min(1.0, std::abs(n_W.dot(axis)) + turn_[i] - turn_common);
      continue;
    }
    const Vector3d J = axis.cross(p_WP - X.translation());
    const double lever = J.norm();
    const double above = turn_[i] - turn_common - D;
    sum += std::min(chord_[i] * lever, D * (std::abs(n_W.dot(J)) + lever * (0.5 * D + above)));
  }
  return sum;
}

}  // namespace tandem::collision
