#include "tandem/collision/ssv_scratch.h"

#include <algorithm>
#include <cmath>

namespace tandem::collision {

using Eigen::Vector3d;

SsvScratch::SsvScratch(const SsvModel& model)
    : model_(model),
      q_(Eigen::VectorXd::Zero(model.dof)),
      X_WJ_(model.joints.size(), Eigen::Isometry3d::Identity()),
      p_WC_(static_cast<std::size_t>(model.node_slots)),
      D_(model.joints.size()),
      chord_(model.joints.size()),
      turn_(model.joints.size()),
      travel_(p_WC_.size() * static_cast<std::size_t>(model.depth)),
      core_travel_(static_cast<std::size_t>(model.shape_slots)),
      pose_time_(model.joints.size()),
      center_time_(p_WC_.size()),
      shape_time_(static_cast<std::size_t>(model.shape_slots)),
      travel_time_(p_WC_.size()) {
  shape_W_.reserve(shape_time_.size());
  for (const SsvShape& shape : model.shapes) {
    if (shape.slot >= 0) shape_W_.push_back(shape.shape_J);
  }
  certificate.q.resize(model.dof);
  certificate.D.resize(model.dof);
}

std::size_t SsvScratch::memory() const {
  const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list.front()); };
  return sizeof(*this) + bytes(X_WJ_) + bytes(p_WC_) + bytes(shape_W_) + bytes(D_) + bytes(chord_) +
         bytes(turn_) + bytes(travel_) + bytes(core_travel_) + bytes(pose_time_) +
         bytes(center_time_) + bytes(shape_time_) + bytes(travel_time_);
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

void SsvScratch::place_node(const SsvNode& node) {
  const auto slot = static_cast<std::size_t>(node.slot);
  const Eigen::Isometry3d& X_WJ = pose(node.joint);
  p_WC_[slot].noalias() = X_WJ.linear() * node.p_JC;
  p_WC_[slot] += X_WJ.translation();
  center_time_[slot] = now_;
}

void SsvScratch::place_shape(const SsvNode& leaf, const SsvShape& shape) {
  const auto slot = static_cast<std::size_t>(shape.slot);
  shape_W_[slot] = shape.shape_J.in(pose(leaf.joint));
  shape_time_[slot] = now_;
}

const geometry::Shape& SsvScratch::surface_piece(int leaf, int side) {
  BuiltPiece& built = built_[side];
  const SsvNode& node = model_.node(leaf);
  if (built.leaf == leaf && (node.joint < 0 || built.time == now_)) return *built.shape_W;
  const SsvSurface& placed = model_.surfaces[static_cast<std::size_t>(node.surface())];
  const geometry::Shape piece_S = placed.surface->piece(node.piece, placed.padding);
  built.shape_W = piece_S.in(node.joint < 0 ? placed.X_JS : pose(node.joint) * placed.X_JS);
  built.leaf = leaf;
  built.time = now_;
  return *built.shape_W;
}

double SsvScratch::box_distance(int node, int leaf) {
  const SsvNode& of_leaf = model_.node(leaf);
  const SsvShape& box = model_.shape(of_leaf.piece);
  Vector3d p_J = center(node);
  if (of_leaf.joint >= 0) {
    const Eigen::Isometry3d& X_WJ = pose(of_leaf.joint);
    p_J = X_WJ.linear().transpose() * (p_J - X_WJ.translation());
  }
  const Vector3d p_B = box.R_BJ * (p_J - box.p_JBo);
  const Vector3d beyond = p_B.cwiseAbs() - box.half;
  const double deepest = beyond.maxCoeff();
  return (deepest > 0 ? beyond.cwiseMax(0.0).norm() : deepest) - box.shape_J.radius() -
         model_.node(node).radius;
}

void SsvScratch::gradient(const PairClearance& clearance, std::span<double> out) {
  const SsvPair& pair = model_.pair(clearance.pair);
  const Vector3d n = clearance.nhat_BA_W;
  std::ranges::fill(out, 0.0);
  add_gradient(n, clearance.p_WCa, model_.body(pair.body_a).joint, pair.common, out);
  add_gradient(-n, clearance.p_WCb, model_.body(pair.body_b).joint, pair.common, out);
}

/// How point P of `joint` moves along n by the joints below `common`.
void SsvScratch::add_gradient(const Vector3d& n_W, const Vector3d& p_WP, int joint, int common,
                              std::span<double> out) {
  for (int j = joint; j != common; j = model_.joints[static_cast<std::size_t>(j)].parent) {
    const SsvJoint& moved = model_.joints[static_cast<std::size_t>(j)];
    const Eigen::Isometry3d& X = pose(j);
    const Vector3d axis = X.linear().col(2);
    const double rate =
        moved.prismatic ? n_W.dot(axis) : n_W.dot(axis.cross(p_WP - X.translation()));
    out[static_cast<std::size_t>(moved.column)] += moved.multiplier * rate;
  }
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
double SsvScratch::travel_by(std::size_t j, const Vector3d& p_WP) const {
  const Eigen::Isometry3d& X = X_WJ_[j];
  return model_.joints[j].prismatic
             ? chord_[j]
             : chord_[j] * X.linear().col(2).cross(p_WP - X.translation()).norm();
}

void SsvScratch::bound_travel(int node) {
  const SsvNode& n = model_.node(node);
  const Vector3d p = center(node);
  double* row = &travel_[static_cast<std::size_t>(n.slot) * static_cast<std::size_t>(model_.depth)];
  double sum = 0;
  for (int j = n.joint; j >= 0; j = model_.joints[static_cast<std::size_t>(j)].parent) {
    const auto i = static_cast<std::size_t>(j);
    sum += travel_by(i, p);
    row[model_.joints[i].depth - 1] = sum;
  }
  travel_time_[static_cast<std::size_t>(n.slot)] = now_;
}

double SsvScratch::travel_of_point(const Vector3d& p_WP, int joint, int shared) {
  double sum = 0;
  for (int j = joint; model_.depth_of(j) > shared;
       j = model_.joints[static_cast<std::size_t>(j)].parent) {
    sum += travel_by(static_cast<std::size_t>(j), p_WP);
  }
  return sum;
}

double SsvScratch::core_travel(int leaf, int shared, int side) {
  const SsvNode& node = model_.node(leaf);
  if (model_.depth_of(node.joint) <= shared) return 0;
  const int slot = node.is_shape() ? model_.shape(node.piece).slot : -1;
  if (slot < 0) return bound_core_travel(leaf, shared, side);
  CoreTravel& known = core_travel_[static_cast<std::size_t>(slot)];
  if (known.time < now_ || known.shared != shared) {
    known = {now_, shared, bound_core_travel(leaf, shared, side)};
  }
  return known.travel;
}

// The bound is convex in the point, so that it is greatest at a vertex.
double SsvScratch::bound_core_travel(int leaf, int shared, int side) {
  const int joint = model_.node(leaf).joint;
  double most = 0;
  for_each_vertex(leaf, side, [&](const Vector3d& v_W) {
    most = std::max(most, travel_of_point(v_W, joint, shared));
  });
  return most;
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
