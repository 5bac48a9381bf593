#include "tandem/collision/ssv_model.h"

#include <algorithm>
#include <cmath>

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A link's place in the compiled tree.
struct LinkFrame {
  int joint = -1;
  Isometry3d X_JL = Isometry3d::Identity();
};

Isometry3d joint_motion(const robot::Joint& joint, double value) {
  Isometry3d X = Isometry3d::Identity();
  if (joint.type == robot::JointType::kPrismatic) {
    X.translation() = value * joint.axis_J;
  } else if (joint.type != robot::JointType::kFixed) {
    X.linear() = Eigen::AngleAxisd(value, joint.axis_J).toRotationMatrix();
  }
  return X;
}

/// Which entry of q stands behind each entry of a position vector, or -1.
std::vector<int> columns_of_positions(const world::Workcell& cell) {
  std::vector<int> columns(static_cast<std::size_t>(cell.model().position_count()), -1);
  for (const world::Arm& arm : cell.arms()) {
    for (int k = 0; k < arm.dof(); ++k) {
      columns[static_cast<std::size_t>(arm.columns[static_cast<std::size_t>(k)])] = arm.offset + k;
    }
  }
  return columns;
}

/// Compiles the joints: those that no arm moves become constants.
std::vector<LinkFrame> add_joints(const world::Workcell& cell, SsvModel& model) {
  const robot::Model& robot = cell.model();
  const std::vector<int> columns = columns_of_positions(cell);
  Eigen::VectorXd positions;
  cell.positions(Eigen::VectorXd::Zero(cell.dof()), positions);
  std::vector<LinkFrame> frames(robot.links().size());
  for (std::size_t l = 0; l < frames.size(); ++l) {
    const int joint_index = robot.links()[l].parent_joint;
    if (joint_index < 0) continue;
    const robot::Joint& joint = robot.joints()[static_cast<std::size_t>(joint_index)];
    const LinkFrame& parent = frames[static_cast<std::size_t>(joint.parent_link)];
    const Isometry3d X_PJ = parent.X_JL * joint.X_PJ;
    const robot::Joint& source =
        joint.mimic ? robot.joints()[static_cast<std::size_t>(joint.mimic->joint)] : joint;
    const double multiplier = joint.mimic ? joint.mimic->multiplier : 1.0;
    const double offset = joint.mimic ? joint.mimic->offset : 0.0;
    const int position = joint.type == robot::JointType::kFixed ? -1 : source.position_index;
    const int column = position < 0 ? -1 : columns[static_cast<std::size_t>(position)];
    if (column < 0) {
      const double value = position < 0 ? 0.0 : multiplier * positions[position] + offset;
      frames[l] = {parent.joint, X_PJ * joint_motion(joint, value)};
      continue;
    }
    const Matrix3d R_JA =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), joint.axis_J).toRotationMatrix();
    SsvJoint compiled{parent.joint,
                      model.depth_of(parent.joint) + 1,
                      X_PJ,
                      joint.type == robot::JointType::kPrismatic,
                      column,
                      multiplier,
                      offset,
                      0,
                      0};
    compiled.X_PJ.linear() = X_PJ.linear() * R_JA;
    const double at_lower = multiplier * cell.lower()[column] + offset;
    const double at_upper = multiplier * cell.upper()[column] + offset;
    compiled.lower = std::min(at_lower, at_upper);
    compiled.upper = std::max(at_lower, at_upper);
    model.depth = std::max(model.depth, compiled.depth);
    frames[l].joint = static_cast<int>(model.joints.size());
    frames[l].X_JL.linear() = R_JA.transpose();
    model.joints.push_back(compiled);
  }
  return frames;
}

/// Right-handed rows that span the core's box: along its extents where it has some.
Matrix3d box_axes(const Shape& shape) {
  const Matrix3d& u = shape.extents();
  if (shape.type() == CoreType::kPoint) return Matrix3d::Identity();
  const Vector3d x = u.col(0).normalized();
  Vector3d y = x.unitOrthogonal();
  if (shape.size_count() > 1) y = (u.col(1) - x.dot(u.col(1)) * x).normalized();
  Matrix3d R;
  R << x.transpose(), y.transpose(), x.cross(y).transpose();
  return R;
}

SsvShape compile_shape(const Shape& shape_J) {
  SsvShape compiled{shape_J, shape_J.hull_vertices(), box_axes(shape_J), {}, {}};
  Vector3d low = Vector3d::Constant(kInfinity), high = -low;
  for (const Matrix3d& R = compiled.R_BJ; const Vector3d& p_J : compiled.vertices_J) {
    low = low.cwiseMin(R * p_J);
    high = high.cwiseMax(R * p_J);
  }
  if (shape_J.type() == CoreType::kCylinder) {  // Its hull's corners may lie askew to the box.
    const Vector3d center = compiled.R_BJ * shape_J.origin();
    const double half_length = shape_J.extents().col(0).norm();
    const Vector3d half(half_length, shape_J.core_radius(), shape_J.core_radius());
    low = center - half;
    high = center + half;
  }
  compiled.p_JBo = compiled.R_BJ.transpose() * (0.5 * (low + high));
  compiled.half = 0.5 * (high - low);
  return compiled;
}

/// How far a shape reaches from p [m].
double reach(const SsvShape& shape, const SsvNode& node, const Vector3d& p_J) {
  double furthest = 0;
  for (const Vector3d& v : shape.vertices_J) furthest = std::max(furthest, (v - p_J).norm());
  return std::min(furthest + shape.shape_J.radius(), (node.p_JC - p_J).norm() + node.radius);
}

/// A nearly smallest sphere around all shapes of a body.
/// Ref: Badoiu, Clarkson, Smaller core-sets for balls (2003).
SsvNode enclosing_sphere(const SsvModel& model, const SsvBody& body,
                         const std::vector<SsvNode>& shape_nodes) {
  constexpr int kRounds = 300;
  const auto first = static_cast<std::size_t>(body.first_shape);
  if (body.shape_count == 1) return shape_nodes[first];
  const std::size_t last = first + static_cast<std::size_t>(body.shape_count);
  SsvNode best{body.joint, Vector3d::Zero(), kInfinity};
  Vector3d center = shape_nodes[first].p_JC;
  for (int round = 1; round <= kRounds; ++round) {
    double radius = 0;
    std::size_t furthest = first;
    for (std::size_t s = first; s < last; ++s) {
      const double r = reach(model.shapes[s], shape_nodes[s], center);
      if (r > radius) {
        radius = r;
        furthest = s;
      }
    }
    if (radius < best.radius) best = {body.joint, center, radius};
    Vector3d towards = shape_nodes[furthest].p_JC;
    for (const Vector3d& v : model.shapes[furthest].vertices_J) {
      if ((v - center).squaredNorm() > (towards - center).squaredNorm()) towards = v;
    }
    center += (towards - center) / (round + 1.0);
  }
  return best;
}

int common_joint(const SsvModel& model, int a, int b) {
  // Parents come first, so the later of two joints is never above the other.
  while (a != b) {
    int& later = a > b ? a : b;
    later = model.joints[static_cast<std::size_t>(later)].parent;
  }
  return a;
}

/// Where a point may be, seen from a joint's frame: in a cylinder about the joint's axis and in a
/// ball about its origin.
struct Region {
  double low, high;  ///< Along the axis [m].
  double radius;     ///< From the axis [m].
  double ball;       ///< From the origin [m].
};

/// The region of a point in the frame of `joint`, seen from a frame with z along its axis that is
/// fixed in the parent's frame P; then from P itself.
Region seen_from_parent(const SsvJoint& joint, Region r) {
  if (joint.prismatic) {
    r.low += joint.lower;
    r.high += joint.upper;
    r.ball += std::max(std::abs(joint.lower), std::abs(joint.upper));
  }
  const Vector3d t = joint.X_PJ.translation(), axis = joint.X_PJ.linear().col(2);
  if (!std::isfinite(r.ball)) return {-kInfinity, kInfinity, kInfinity, kInfinity};
  const double sine = std::hypot(axis.x(), axis.y()), cosine = std::abs(axis.z());
  Region seen{kInfinity, -kInfinity, 0, t.norm() + r.ball};
  for (const double z : {r.low, r.high}) {
    const Vector3d c = t + z * axis;
    seen.low = std::min(seen.low, c.z() - r.radius * sine);
    seen.high = std::max(seen.high, c.z() + r.radius * sine);
    // Seen along z, the disc about c is an ellipse: `cosine` as long along the axis' projection.
    double extent = c.head<2>().norm() + r.radius;
    if (sine > 0) {
      const Eigen::Vector2d along = axis.head<2>() / sine;
      const double cu = std::abs(along.dot(c.head<2>()));
      const double cw = std::abs(along.x() * c.y() - along.y() * c.x());
      extent = std::min(extent, std::hypot(cu + r.radius * cosine, cw + r.radius));
    }
    seen.radius = std::max(seen.radius, extent);
  }
  seen.ball = std::min(seen.ball, std::hypot(std::max(-seen.low, seen.high), seen.radius));
  seen.radius = std::min(seen.radius, seen.ball);
  seen.low = std::max(seen.low, -seen.ball);
  seen.high = std::min(seen.high, seen.ball);
  return seen;
}

}  // namespace

SsvModel::SsvModel(const world::Workcell& cell) : dof(cell.dof()) {
  const std::vector<LinkFrame> frames = add_joints(cell, *this);
  std::vector<SsvNode> shape_nodes;
  for (const world::Body& body : cell.bodies()) {
    const LinkFrame& frame = frames[static_cast<std::size_t>(body.link)];
    bodies.push_back(
        {frame.joint, static_cast<int>(shapes.size()), static_cast<int>(body.shapes_L.size())});
    for (const Shape& shape_L : body.shapes_L) {
      const Shape shape_J = shape_L.in(frame.X_JL).padded(body.padding);
      shapes.push_back(compile_shape(shape_J));
      shape_nodes.push_back({frame.joint, shape_J.bounding_center(), shape_J.bounding_radius()});
    }
    nodes.push_back(enclosing_sphere(*this, bodies.back(), shape_nodes));
  }
  nodes.insert(nodes.end(), shape_nodes.begin(), shape_nodes.end());
  for (const world::BodyPair& pair : cell.pairs()) {
    const int joint_a = bodies[static_cast<std::size_t>(pair.a)].joint;
    const int joint_b = bodies[static_cast<std::size_t>(pair.b)].joint;
    const int common = common_joint(*this, joint_a, joint_b);
    pairs.push_back(
        {pair.a, pair.b, common, depth_of(common), joint_a == common, joint_b == common});
  }
}

Eigen::MatrixXd SsvModel::lever_arms() const {
  Eigen::MatrixXd levers = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(bodies.size()), dof);
  Eigen::VectorXd of_vertex(dof);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int s = 0; s < bodies[b].shape_count; ++s) {
      for (const Vector3d& v :
           shapes[static_cast<std::size_t>(bodies[b].first_shape + s)].vertices_J) {
        of_vertex.setZero();
        Region region{v.z(), v.z(), v.head<2>().norm(), v.norm()};
        for (int j = bodies[b].joint; j >= 0; j = joints[static_cast<std::size_t>(j)].parent) {
          const SsvJoint& joint = joints[static_cast<std::size_t>(j)];
          of_vertex[joint.column] +=
              std::abs(joint.multiplier) * (joint.prismatic ? 1.0 : region.radius);
          region = seen_from_parent(joint, region);
        }
        const auto row = static_cast<Eigen::Index>(b);
        levers.row(row) = levers.row(row).cwiseMax(of_vertex.transpose());
      }
    }
  }
  return levers;
}

}  // namespace tandem::collision
