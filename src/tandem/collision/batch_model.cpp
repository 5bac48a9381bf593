#include "tandem/collision/batch_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/collision/link_frame.h"

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = 0x1p-24;  ///< Of one rounding in single precision.
/// Roundings of the size of the cell that a distance may suffer: seven joints of a dozen each,
/// seldom all of one sign. Tests measure a tenth of it.
constexpr double kRoundings = 64;
/// Axes this parallel are the same: over a metre, less than single precision sees [-].
constexpr double kParallel = 1e-8;

Vector3f3 to_float(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// The entries in the order of storage: columns of a matrix.
std::array<float, 9> matrix_to_float(const Matrix3d& M) {
  std::array<float, 9> all;
  for (Eigen::Index i = 0; i < 9; ++i) all[static_cast<std::size_t>(i)] = static_cast<float>(M(i));
  return all;
}

/// Up to the next float: bounds stay bounds.
float round_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

/// A moving joint as its own; a standing one becomes part of the frame.
void add_joint(const world::Workcell& cell, const robot::Joint& joint, int column,
               const LinkFrame& parent, LinkFrame& child, BatchModel& model) {
  BatchJoint compiled{};
  compiled.parent = parent.joint;
  compiled.depth = model.depth_of(parent.joint) + 1;
  compiled.column = column;
  compiled.prismatic = joint.type == robot::JointType::kPrismatic;
  compiled.multiplier = joint.mimic ? joint.mimic->multiplier : 1.0;
  compiled.offset = joint.mimic ? joint.mimic->offset : 0.0;
  const double at_lower = compiled.multiplier * cell.lower()[column] + compiled.offset;
  const double at_upper = compiled.multiplier * cell.upper()[column] + compiled.offset;
  compiled.lower = std::min(at_lower, at_upper);
  compiled.upper = std::max(at_lower, at_upper);
  const Matrix3d R_JA =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), joint.axis_J).toRotationMatrix();
  compiled.X_PJ = parent.X_JL * joint.X_PJ;
  compiled.X_PJ.linear() = compiled.X_PJ.linear() * R_JA;
  child.joint = static_cast<int>(model.joints.size());
  child.X_JL.linear() = R_JA.transpose();
  model.depth = std::max(model.depth, compiled.depth);
  model.joints.push_back(compiled);
}

std::vector<LinkFrame> add_joints(const world::Workcell& cell, BatchModel& model) {
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
    const robot::Joint& source =
        joint.mimic ? robot.joints()[static_cast<std::size_t>(joint.mimic->joint)] : joint;
    const int position = joint.type == robot::JointType::kFixed ? -1 : source.position_index;
    const int column = position < 0 ? -1 : columns[static_cast<std::size_t>(position)];
    if (column >= 0) {
      add_joint(cell, joint, column, parent, frames[l], model);
      continue;
    }
    double value = position < 0 ? 0.0 : positions[position];
    if (joint.mimic) value = joint.mimic->multiplier * value + joint.mimic->offset;
    frames[l] = {parent.joint, parent.X_JL * joint.X_PJ * joint_motion(joint, value)};
  }
  return frames;
}

/// Right-handed rows that span the core's box: along its extents where it has some.
Matrix3d box_axes(const Shape& shape) {
  const Matrix3d& u = shape.extents();
  if (shape.size_count() == 0) return Matrix3d::Identity();
  const Vector3d x = u.col(0).norm() > 0 ? Vector3d(u.col(0).normalized()) : Vector3d::UnitX();
  Vector3d y = x.unitOrthogonal();
  if (shape.size_count() > 1) y = (u.col(1) - x.dot(u.col(1)) * x).normalized();
  Matrix3d R;
  R << x.transpose(), y.transpose(), x.cross(y).transpose();
  return R;
}

/// Polytopes of more vertices are left to the exact checker, which climbs from vertex to vertex.
constexpr std::size_t kMostVertices = 64;

BatchCore core_of(const Shape& shape) {
  switch (shape.type()) {
    case CoreType::kPoint:
      return BatchCore::kPoint;
    case CoreType::kSegment:
      return BatchCore::kSegment;
    case CoreType::kRectangle:
    case CoreType::kBox:
      return BatchCore::kBox;
    case CoreType::kCylinder:
      return BatchCore::kCylinder;
    case CoreType::kTriangle:
      return BatchCore::kPolytope;
    case CoreType::kConvex:
      return shape.hull().vertices.size() <= kMostVertices ? BatchCore::kPolytope
                                                           : BatchCore::kOpaque;
  }
  return BatchCore::kOpaque;
}

/// Something with a box around it, before it is rounded to single precision.
struct Boxed {
  BatchCore core;
  int joint;
  Matrix3d R_BJ;
  Vector3d low, high;  ///< In B, about Jo.
  double radius;
  std::vector<Vector3d> vertices_B = {};  ///< Of a polytope, about Jo.
};

void include(Boxed& box, const Vector3d& p_J) {
  const Vector3d p_B = box.R_BJ * p_J;
  box.low = box.low.cwiseMin(p_B);
  box.high = box.high.cwiseMax(p_B);
}

Boxed box_around(const Shape& shape_J, int joint) {
  const Vector3d far = Vector3d::Constant(kInfinity);
  Boxed box{core_of(shape_J), joint, box_axes(shape_J), far, -far, shape_J.radius()};
  if (box.core == BatchCore::kCylinder) {  // Its hull's corners may lie askew to the box.
    const double core_radius = shape_J.core_radius();
    const Vector3d half(shape_J.extents().col(0).norm(), core_radius, core_radius);
    const Vector3d center = box.R_BJ * shape_J.origin();
    box.low = center - half;
    box.high = center + half;
    return box;
  }
  for (const Vector3d& p_J : shape_J.hull_vertices()) {
    include(box, p_J);
    if (box.core == BatchCore::kPolytope) box.vertices_B.push_back(box.R_BJ * p_J);
  }
  return box;
}

Boxed box_around(const geometry::PlacedSurface& surface_J, int joint, double padding) {
  const Vector3d far = Vector3d::Constant(kInfinity);
  Boxed box{BatchCore::kOpaque,
            joint,
            surface_J.X_FS.linear().transpose(),
            far,
            -far,
            surface_J.surface->radius() + padding};
  for (const Vector3d& p_S : surface_J.surface->vertices()) include(box, surface_J.X_FS * p_S);
  return box;
}

/// Whether the rows of R are unit vectors of C, in any order and direction.
bool is_permutation(const Matrix3d& R) {
  return ((R.cwiseAbs().array() < kParallel) || (R.cwiseAbs().array() > 1 - kParallel)).all();
}

/// The axes of most standing boxes.
Matrix3d common_axes(const std::vector<Boxed>& shapes) {
  struct Candidate {
    Matrix3d R;
    int votes;
  };
  constexpr std::size_t kMost = 32;  // Boxes that all stand askew have no common axes.
  std::vector<Candidate> candidates{{Matrix3d::Identity(), 0}};
  for (const Boxed& box : shapes) {
    if (box.joint >= 0 || box.core == BatchCore::kPoint || box.core == BatchCore::kSegment)
      continue;
    const auto same = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
      return is_permutation(box.R_BJ * candidate.R.transpose());
    });
    if (same != candidates.end()) {
      ++same->votes;
    } else if (candidates.size() < kMost) {
      candidates.push_back({box.R_BJ, 1});
    }
  }
  return std::ranges::max_element(candidates, {}, &Candidate::votes)->R;
}

/// Amid the bases of the arms.
Vector3d middle_of_bases(const BatchModel& model) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const BatchJoint& joint : model.joints) {
    if (joint.parent >= 0) continue;
    sum += joint.X_PJ.translation();
    ++count;
  }
  return sum / std::max(count, 1);
}

/// The furthest that anything moving may be from Co [m].
double furthest_reach(const BatchModel& model, const std::vector<Boxed>& shapes) {
  std::vector<double> of_joint;
  for (const BatchJoint& joint : model.joints) {
    const double above = joint.parent < 0 ? 0.0 : of_joint[static_cast<std::size_t>(joint.parent)];
    const double slide =
        joint.prismatic ? std::max(std::abs(joint.lower), std::abs(joint.upper)) : 0.0;
    of_joint.push_back(above + joint.X_PJ.translation().norm() +
                       (std::isfinite(slide) ? slide : 0.0));
  }
  double furthest = 0;
  for (const Boxed& box : shapes) {
    if (box.joint < 0) continue;
    const double extent = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm() + box.radius;
    furthest = std::max(furthest, of_joint[static_cast<std::size_t>(box.joint)] + extent);
  }
  return furthest;
}

/// Rounds a shape, with a margin that covers this and what its kernels round [m].
BatchShape compile_shape(Boxed box, BatchModel& model) {
  BatchShape shape{};
  shape.first_vertex = static_cast<int>(model.vertices.size());
  shape.vertex_count = static_cast<int>(box.vertices_B.size());
  const Vector3d middle = 0.5 * (box.high + box.low);
  for (const Vector3d& v_B : box.vertices_B) model.vertices.push_back(to_float(v_B - middle));
  shape.core = box.core;
  shape.joint = box.joint;
  shape.slot = box.joint < 0 ? -1 : model.moving_shapes++;
  if (box.joint < 0) {
    box.R_BJ = box.R_BJ * model.X_CW.linear().transpose();
    const Vector3d shift = box.R_BJ * model.X_CW.translation();
    box.low += shift;
    box.high += shift;
  }
  Vector3d half = 0.5 * (box.high - box.low);
  const Vector3d p_JC = box.R_BJ.transpose() * (0.5 * (box.high + box.low));
  const bool point_like = half.maxCoeff() < kParallel;
  const bool segment_like = half[1] < kParallel && half[2] < kParallel;
  const Vector3d x = box.R_BJ.row(0).transpose();
  const bool exact = box.core <= BatchCore::kBox;
  if (box.joint < 0 && exact &&
      (point_like || is_permutation(box.R_BJ) ||
       (segment_like && x.cwiseAbs().maxCoeff() > 1 - kParallel))) {
    half = box.R_BJ.transpose().cwiseAbs() * half;
    box.R_BJ.setIdentity();
    shape.aligned = true;
    if (box.core == BatchCore::kSegment) shape.core = BatchCore::kBox;
  }
  // A shape that reaches further than the arms is rounded by its own size. Nearest points are
  // found on cores: their error shows most where cores nearly touch, so under small radii.
  const double size = p_JC.norm() + half.norm();
  const double blunt = std::max(box.radius, 1e-3);
  const double sharp = std::min(half.norm() * half.norm() / blunt, half.norm());
  const double margin = 0.5 * model.margin + kEpsilon * (8 * size + 8 * sharp);
  shape.p_JC = to_float(p_JC);
  shape.R_BJ = matrix_to_float(Matrix3d(box.R_BJ.transpose()));  // Rows, in order of storage.
  shape.half = to_float(half);
  shape.outer = round_up(box.radius + margin);
  shape.inner = static_cast<float>(box.radius - margin);
  shape.circumradius = round_up(half.norm() * (1 + 1e-6));
  shape.inverse = static_cast<float>(1 / std::max(half.squaredNorm(), 1e-30));
  if (box.core == BatchCore::kCylinder) {
    shape.circumradius = round_up(std::hypot(half[0], half[1]) * (1 + 1e-6));
  }
  return shape;
}

/// Spheres that together contain a shape: at the vertices of a segment, else one around.
void add_balls(const BatchShape& shape, std::vector<Ball>& balls) {
  const Vector3d p(shape.p_JC[0], shape.p_JC[1], shape.p_JC[2]);
  const Vector3d x(shape.R_BJ[0], shape.R_BJ[1], shape.R_BJ[2]);
  const Vector3d y(shape.R_BJ[3], shape.R_BJ[4], shape.R_BJ[5]);
  const Vector3d z(shape.R_BJ[6], shape.R_BJ[7], shape.R_BJ[8]);
  if (shape.core == BatchCore::kCylinder || shape.core == BatchCore::kPoint) {
    balls.push_back({p, static_cast<double>(shape.bound())});
    return;
  }
  const Vector3d half(shape.half[0], shape.half[1], shape.half[2]);
  for (const double i : {-1.0, 1.0}) {
    for (const double j : {-1.0, 1.0}) {
      if (j > 0 && half[1] == 0) continue;
      for (const double k : {-1.0, 1.0}) {
        if (k > 0 && half[2] == 0) continue;
        balls.push_back({p + i * half[0] * x + j * half[1] * y + k * half[2] * z,
                         static_cast<double>(shape.outer)});
      }
    }
  }
}

BatchSphere to_sphere(const Ball& ball) {
  return {to_float(ball.center), round_up((1 + 1e-6) * ball.radius + 1e-7 * ball.center.norm())};
}

/// The rounded box along C's axes around a standing body.
void bound_standing(const BatchModel& model, BatchBody& body) {
  Vector3d low = Vector3d::Constant(kInfinity), high = -low;
  for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
    const BatchShape& shape = model.shapes[static_cast<std::size_t>(s)];
    const Vector3d p(shape.p_JC[0], shape.p_JC[1], shape.p_JC[2]);
    Vector3d extent = Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 3; ++i) {
        extent[i] += std::abs(shape.R_BJ[static_cast<std::size_t>(3 * axis + i)]) *
                     shape.half[static_cast<std::size_t>(axis)];
      }
    }
    low = low.cwiseMin(p - extent);
    high = high.cwiseMax(p + extent);
    body.outer = std::max(body.outer, shape.outer);
  }
  body.p_CB = to_float(0.5 * (low + high));
  body.half = to_float(0.5 * (high - low));
  body.outer += static_cast<float>(4 * kEpsilon * (low.norm() + high.norm()));
}

/// A body before it is rounded.
struct BoxedBody {
  int joint;
  std::vector<Boxed> boxes;
};

BoxedBody box_body(const world::Body& body, const LinkFrame& frame) {
  BoxedBody boxed{frame.joint, {}};
  for (const Shape& shape_L : body.shapes_L) {
    boxed.boxes.push_back(box_around(shape_L.in(frame.X_JL).padded(body.padding), frame.joint));
  }
  for (geometry::PlacedSurface surface : body.surfaces_L) {
    surface.X_FS = frame.X_JL * surface.X_FS;
    boxed.boxes.push_back(box_around(surface, frame.joint, body.padding));
  }
  return boxed;
}

float margin_of(const BatchModel& model, const std::vector<Boxed>& boxes) {
  return static_cast<float>(kRoundings * kEpsilon * furthest_reach(model, boxes));
}

/// Sees the joints from C.
void place_joints(BatchModel& model) {
  for (BatchJoint& joint : model.joints) {
    if (joint.parent < 0) joint.X_PJ = model.X_CW * joint.X_PJ;
    // Right angles written with ten digits become right angles, which cost less to turn by.
    const Matrix3d R_PJ = joint.X_PJ.linear().unaryExpr(
        [](double entry) { return std::abs(entry) < kParallel ? 0.0 : entry; });
    joint.R_PJ = matrix_to_float(R_PJ);
    joint.p_PJ = to_float(joint.X_PJ.translation());
  }
}

std::vector<Ball> balls_of(const BatchModel& model, const BatchBody& body) {
  std::vector<Ball> balls;
  for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
    add_balls(model.shapes[static_cast<std::size_t>(s)], balls);
  }
  return balls;
}

void add_body(const BoxedBody& boxed, BatchModel& model) {
  BatchBody body{
      boxed.joint, static_cast<int>(model.shapes.size()), static_cast<int>(boxed.boxes.size()), {}};
  for (const Boxed& box : boxed.boxes) model.shapes.push_back(compile_shape(box, model));
  const auto first = model.shapes.begin() + body.first_shape;
  // Of one shape this is the sphere around its box already.
  body.sphere = body.shape_count == 1 && boxed.joint < 0
                    ? to_sphere({Vector3d(first->p_JC[0], first->p_JC[1], first->p_JC[2]),
                                 static_cast<double>(first->bound())})
                    : to_sphere(enclosing_ball(balls_of(model, body)));
  body.is_spheres = std::all_of(first, model.shapes.end(), [](const BatchShape& shape) {
    return shape.core == BatchCore::kPoint;
  });
  if (body.joint < 0) bound_standing(model, body);
  model.bodies.push_back(body);
}

/// Spheres around everything at a joint.
void bound_groups(BatchModel& model) {
  std::vector<std::vector<Ball>> balls_of_group(model.joints.size());
  model.groups.resize(model.joints.size());
  model.group_sizes.assign(model.joints.size(), 0);
  for (const BatchBody& body : model.bodies) {
    if (body.joint < 0) continue;
    ++model.group_sizes[static_cast<std::size_t>(body.joint)];
    auto& of_group = balls_of_group[static_cast<std::size_t>(body.joint)];
    const std::vector<Ball> balls = balls_of(model, body);
    of_group.insert(of_group.end(), balls.begin(), balls.end());
  }
  for (std::size_t g = 0; g < model.joints.size(); ++g) {
    const std::vector<Ball>& balls = balls_of_group[g];
    model.groups[g] = balls.empty() ? BatchSphere{{}, -1.0F} : to_sphere(enclosing_ball(balls));
  }
}

}  // namespace

BatchModel::BatchModel(const world::Workcell& cell) : dof(cell.dof()) {
  const std::vector<LinkFrame> frames = add_joints(cell, *this);
  std::vector<BoxedBody> boxed;
  std::vector<Boxed> boxes;
  for (const world::Body& body : cell.bodies()) {
    boxed.push_back(box_body(body, frames[static_cast<std::size_t>(body.link)]));
    boxes.insert(boxes.end(), boxed.back().boxes.begin(), boxed.back().boxes.end());
  }
  X_CW = Isometry3d::Identity();
  X_CW.linear() = common_axes(boxes);
  X_CW.translation() = -(X_CW.linear() * middle_of_bases(*this));
  place_joints(*this);
  margin = margin_of(*this, boxes);
  for (const BoxedBody& body : boxed) add_body(body, *this);
  bound_groups(*this);
  for (BatchBody& body : bodies) measure_spans(body);
  bound_levers(*this);
}

void BatchModel::measure_spans(BatchBody& body) {
  const auto distance = [](const Vector3f3& a, const Vector3f3& b) {
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i) squared += std::pow(static_cast<double>(a[i]) - b[i], 2);
    return 1.00001 * std::sqrt(squared);
  };
  const Vector3f3& body_center = body.sphere.p_JC;
  const Vector3f3& group_center =
      body.joint < 0 ? body_center : groups[static_cast<std::size_t>(body.joint)].p_JC;
  body.offset = round_up(distance(body_center, group_center));
  for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
    BatchShape& shape = shapes[static_cast<std::size_t>(s)];
    shape.span = round_up(distance(shape.p_JC, body_center) + shape.circumradius);
    shape.offset = round_up(distance(shape.p_JC, group_center) + shape.circumradius);
  }
}

int BatchModel::common_joint(int a, int b) const {
  // Parents come first, so the later of two joints is never above the other.
  while (a != b) {
    int& later = a > b ? a : b;
    later = joints[static_cast<std::size_t>(later)].parent;
  }
  return a;
}

}  // namespace tandem::collision
