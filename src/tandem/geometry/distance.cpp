#include "tandem/geometry/distance.h"

#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/geometry/cylinder.h"
#include "tandem/geometry/orthotope.h"
#include "tandem/geometry/polytope.h"
#include "tandem/geometry/separation.h"

namespace tandem::geometry {

using detail::Nearest, detail::Separation;
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

/// Whether the cores are so far apart that their nearest points are all there is to know.
bool is_apart(const Shape& a, const Shape& b, const Query& found, double gap) {
  if (!(gap > kTouching)) return false;
  return found.proven || detail::separation(a, b, found.nearest.p_BA_W / gap) > 0;
}

/// Best separation of cores that touch or overlap, or nearly, with nearest points `gap` apart.
Separation touching_separation(const Shape& a, const Shape& b, const Nearest& nearest, double gap) {
  Separation best = detail::best_separation(a, b, nearest);
  // Apart after all: of the two bounds the nearest points' is the better, if it is about these.
  if (best.gap > 0 && gap < kTouching) best.gap = gap;
  return best;
}

}  // namespace

Clearance clearance(const Shape& a_W, const Shape& b_W) {
  const Query found = query(a_W, b_W);
  const Nearest& nearest = found.nearest;
  const double gap = std::sqrt(nearest.squared);
  if (is_apart(a_W, b_W, found, gap)) {
    return with_radii(a_W, b_W, nearest.p_BA_W / gap, gap, nearest.p_WCb);
  }
  const auto [nhat_BA_W, depth] = touching_separation(a_W, b_W, nearest, gap);
  if (depth > 0 && gap < kTouching) {
    return with_radii(a_W, b_W, nhat_BA_W, depth, nearest.p_WCb);
  }
  // Moved by the depth the cores just touch, and where they do are the witness points.
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = -depth * nhat_BA_W;
  const Nearest touch = query(a_W.in(X), b_W).nearest;
  return with_radii(a_W, b_W, nhat_BA_W, depth, touch.p_WCb + 0.5 * touch.p_BA_W);
}

double distance(const Shape& a_W, const Shape& b_W) {
  const Query found = query(a_W, b_W);
  const double gap = std::sqrt(found.nearest.squared);
  if (is_apart(a_W, b_W, found, gap)) return gap - a_W.radius() - b_W.radius();
  const double depth = touching_separation(a_W, b_W, found.nearest, gap).gap;
  return depth - a_W.radius() - b_W.radius();
}

double distance_to_point(const Shape& a_W, const Vector3d& p_W) {
  expects(p_W.allFinite(), "distance_to_point: the point must be finite");
  return distance(*Shape::sphere(p_W, 1), a_W) + 1;
}

}  // namespace tandem::geometry
