#include "tandem/geometry/distance.h"

#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/geometry/cylinder.h"
#include "tandem/geometry/orthotope.h"
#include "tandem/geometry/polytope.h"
#include "tandem/geometry/separation.h"

namespace tandem::geometry {

using detail::Nearest;
using Eigen::Vector3d;

namespace {

/// [m] Where cores are nearer than this, rounding turns the line between their nearest points, and
/// the direction comes from the features that touch.
constexpr double kTouching = 1e-8;

constexpr int pair(CoreType first, CoreType second) {
  return 6 * static_cast<int>(first) + static_cast<int>(second);
}

/// Nearest core points, and whether a positive distance proves that the cores are disjoint.
struct Query {
  Nearest nearest;
  bool proven = true;
};

Query query(const Shape& a, const Shape& b) {
  using enum CoreType;
  using namespace detail;
  const auto segment = [](const Shape& shape) {
    return Segment{shape.origin(), shape.extents().col(0)};
  };
  switch (pair(a.type(), b.type())) {
    case pair(kPoint, kPoint):
      return {nearest_point_orthotope<0>(a.origin(), b)};
    case pair(kPoint, kSegment):
      return {nearest_point_orthotope<1>(a.origin(), b)};
    case pair(kPoint, kRectangle):
      return {nearest_point_orthotope<2>(a.origin(), b)};
    case pair(kPoint, kBox):
      return {nearest_point_orthotope<3>(a.origin(), b)};
    case pair(kSegment, kPoint):
      return {nearest_point_orthotope<1>(b.origin(), a).swapped()};
    case pair(kRectangle, kPoint):
      return {nearest_point_orthotope<2>(b.origin(), a).swapped()};
    case pair(kBox, kPoint):
      return {nearest_point_orthotope<3>(b.origin(), a).swapped()};
    case pair(kSegment, kSegment):
      return {nearest_segment_orthotope<1>(segment(a), b)};
    case pair(kSegment, kRectangle):
      return {nearest_segment_orthotope<2>(segment(a), b)};
    case pair(kSegment, kBox):
      return {nearest_segment_orthotope<3>(segment(a), b)};
    case pair(kRectangle, kSegment):
      return {nearest_segment_orthotope<2>(segment(b), a).swapped()};
    case pair(kBox, kSegment):
      return {nearest_segment_orthotope<3>(segment(b), a).swapped()};
    case pair(kPoint, kTriangle):
      return {nearest_point_triangle(a.origin(), Triangle(b))};
    case pair(kTriangle, kPoint):
      return {nearest_point_triangle(b.origin(), Triangle(a)).swapped()};
    default:
      break;
  }
  if (b.type() == kCylinder) {
    if (a.type() == kPoint) return {nearest_point_cylinder(a.origin(), b)};
    if (a.type() == kSegment) return {nearest_segment_cylinder(segment(a), b)};
    return {nearest_with_cylinder(a, b), false};
  }
  if (a.type() == kCylinder) {
    const auto [nearest, proven] = query(b, a);
    return {nearest.swapped(), proven};
  }
  return {nearest_features(a, b), false};
}

/// Adds the radii to core points that are `gap` apart along `nhat`.
Clearance with_radii(const Shape& a, const Shape& b, const Vector3d& nhat, double gap,
                     const Vector3d& p_WCb) {
  const double distance = gap - a.radius() - b.radius();
  const Vector3d p = p_WCb + b.radius() * nhat;
  return {distance, nhat, p + distance * nhat, p};
}

/// Clearance of cores that touch or overlap, or nearly.
Clearance touching_clearance(const Shape& a, const Shape& b, const Nearest& nearest) {
  const detail::Separation best = detail::best_separation(a, b, nearest);
  // Apart after all: of the two bounds the nearest points' is the better, if it is about these.
  const double gap = std::sqrt(nearest.squared);
  if (best.gap > 0 && gap < kTouching) {
    return with_radii(a, b, best.nhat_BA_W, gap, nearest.p_WCb);
  }
  // Moved by the depth the cores just touch, and where they do are the witness points.
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = -best.gap * best.nhat_BA_W;
  const Nearest touch = query(a.in(X), b).nearest;
  return with_radii(a, b, best.nhat_BA_W, best.gap, touch.p_WCb + 0.5 * touch.p_BA_W);
}

}  // namespace

Clearance clearance(const Shape& a_W, const Shape& b_W) {
  const auto [nearest, proven] = query(a_W, b_W);
  const double gap = std::sqrt(nearest.squared);
  if (gap > kTouching) {
    const Vector3d nhat_BA_W = nearest.p_BA_W / gap;
    if (proven || detail::separation(a_W, b_W, nhat_BA_W) > 0) {
      return with_radii(a_W, b_W, nhat_BA_W, gap, nearest.p_WCb);
    }
  }
  return touching_clearance(a_W, b_W, nearest);
}

double distance_to_point(const Shape& a_W, const Vector3d& p_W) {
  const auto point = Shape::sphere(p_W, 1);
  expects(point.has_value(), "distance_to_point: the point must be finite");
  return clearance(*point, a_W).distance + 1;
}

}  // namespace tandem::geometry
