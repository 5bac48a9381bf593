#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/collision/batch_model.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {

namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Covers the rounding of bounds to single precision [-].
constexpr double kRoundUp = 1 + 1e-6;

/// Where a point may be, seen from a frame with z along a joint's axis: in a cylinder about the
/// axis and in a ball about the origin.
struct Region {
  double low, high;  ///< Along the axis [m].
  double radius;     ///< From the axis [m].
  double ball;       ///< From the origin [m].

  bool is_finite() const { return std::isfinite(ball); }
};

Region region_of(const Vector3d& p) { return {p.z(), p.z(), p.head<2>().norm(), p.norm()}; }

/// The same for all values of a prismatic joint.
void slide(const BatchJoint& joint, Region& r) {
  if (!joint.prismatic) return;
  r.low += joint.lower;
  r.high += joint.upper;
  r.ball += std::max(std::abs(joint.lower), std::abs(joint.upper));
}

/// The region of a point in the frame of `joint` (slid already), seen from its parent's frame.
Region seen_from_parent(const BatchJoint& joint, const Region& r) {
  if (!r.is_finite()) return {-kInfinity, kInfinity, kInfinity, kInfinity};
  const Vector3d t = joint.X_PJ.translation(), axis = joint.X_PJ.linear().col(2);
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

Vector3d to_vector(const Vector3f3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void bound_levers(BatchModel& model) {
  const auto depth = static_cast<std::size_t>(model.depth);
  model.levers.assign(model.joints.size() * depth, 0.0F);
  for (std::size_t g = 0; g < model.joints.size(); ++g) {
    if (model.groups[g].radius < 0) continue;
    Region region = region_of(to_vector(model.groups[g].p_JC));
    for (int j = static_cast<int>(g); j >= 0;) {
      const BatchJoint& joint = model.joints[static_cast<std::size_t>(j)];
      const double lever = joint.prismatic ? 1.0 : region.radius;
      model.levers[g * depth + static_cast<std::size_t>(joint.depth - 1)] =
          static_cast<float>(kRoundUp * lever);
      slide(joint, region);
      region = seen_from_parent(joint, region);
      j = joint.parent;
    }
  }
}

Reach::Reach(const BatchModel& model, int joint, int common, const BatchSphere& node) {
  Region region = region_of(to_vector(node.p_JC));
  const BatchJoint* first = nullptr;
  for (int j = joint; j != common; j = first->parent) {
    if (first) region = seen_from_parent(*first, region);
    first = &model.joints[static_cast<std::size_t>(j)];
    slide(*first, region);
    if (!region.is_finite()) return;
  }
  if (!first) return;
  // In the frame that the first joint turns in, which stands still in that of `common`.
  const Eigen::Isometry3d& X_PF = first->X_PJ;
  is_bounded_ = true;
  ball_center_ = X_PF.translation();
  ball_radius_ = region.ball + node.radius;
  low_ = X_PF * Vector3d(0, 0, region.low);
  high_ = X_PF * Vector3d(0, 0, region.high);
  radius_ = region.radius + node.radius;
}

bool Reach::may_touch(const StandingShape& standing, double within) const {
  if (!is_bounded_) return true;
  const double from_center = (standing.center_P - ball_center_).norm();
  if (from_center > ball_radius_ + within + standing.bound) return false;
  const auto apart = [&](const Result<geometry::Shape>& around) {
    return around && geometry::distance(*around, standing.shape_P) > 0;
  };
  return !apart(geometry::Shape::sphere(ball_center_, ball_radius_ + within)) &&
         !apart(geometry::Shape::capsule(low_, high_, radius_ + within));
}

Ball enclosing_ball(const std::vector<Ball>& balls) {
  constexpr int kRounds = 100;
  if (balls.size() == 1) return balls.front();
  Ball best{Vector3d::Zero(), kInfinity};
  Vector3d center = balls.front().center;
  for (int round = 1; round <= kRounds; ++round) {
    double radius = 0;
    const Ball* furthest = nullptr;
    for (const Ball& ball : balls) {
      const double r = (ball.center - center).norm() + ball.radius;
      if (r < radius) continue;
      radius = r;
      furthest = &ball;
    }
    if (radius < best.radius) best = {center, radius};
    // Towards the far side of the furthest ball, so that large ones weigh as much as they reach.
    const Vector3d towards = furthest->center - center;
    const double length = towards.norm();
    if (length > 0) center += (radius / length) / (round + 1.0) * towards;
  }
  return best;
}

}  // namespace tandem::collision
