#include "tandem/geometry/distance.h"

#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/geometry/convex_pair.h"
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

/// Nearest core points, and whether a positive distance proves that the cores are disjoint.
struct Query {
  Nearest nearest;
  bool proven = true;
};

/// Nearest points of `p` (as A) and any core.
Nearest nearest_to_point(const Vector3d& p, const Shape& b) {
  using namespace detail;
  switch (b.type()) {
    case CoreType::kPoint:
      return nearest_point_orthotope<0>(p, b);
    case CoreType::kSegment:
      return nearest_point_orthotope<1>(p, b);
    case CoreType::kTriangle:
      return nearest_point_triangle(p, Triangle(b));
    case CoreType::kRectangle:
      return nearest_point_orthotope<2>(p, b);
    case CoreType::kBox:
      return nearest_point_orthotope<3>(p, b);
    case CoreType::kCylinder:
      return nearest_point_cylinder(p, b);
    case CoreType::kConvex:
      return nearest_with_convex(Shape::sphere(p, 1)->padded(-1), b);
  }
  return {};
}

/// Nearest points of a segment (as A) and any core.
Query query_segment(const Shape& a, const Shape& b) {
  using namespace detail;
  const Segment segment{a.origin(), a.extents().col(0)};
  switch (b.type()) {
    case CoreType::kPoint:
      return {nearest_to_point(b.origin(), a).swapped()};
    case CoreType::kSegment:
      return {nearest_segment_orthotope<1>(segment, b)};
    case CoreType::kTriangle:
      return {nearest_features(a, b), false};
    case CoreType::kRectangle:
      return {nearest_segment_orthotope<2>(segment, b)};
    case CoreType::kBox:
      return {nearest_segment_orthotope<3>(segment, b)};
    case CoreType::kCylinder:
      return {nearest_segment_cylinder(segment, b)};
    case CoreType::kConvex:
      return {nearest_with_convex(a, b), false};
  }
  return {};
}

Query query(const Shape& a, const Shape& b) {
  using enum CoreType;
  if (a.type() == kConvex || b.type() == kConvex) return {detail::nearest_with_convex(a, b), false};
  if (a.type() == kPoint) return {nearest_to_point(a.origin(), b)};
  if (a.type() == kSegment) return query_segment(a, b);
  if (b.type() == kPoint || b.type() == kSegment) {
    const auto [nearest, proven] = query(b, a);
    return {nearest.swapped(), proven};
  }
  if (b.type() == kCylinder) return {detail::nearest_with_cylinder(a, b), false};
  if (a.type() == kCylinder) return {detail::nearest_with_cylinder(b, a).swapped(), false};
  return {detail::nearest_features(a, b), false};
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

/// What is known of cores that touch or overlap, or nearly.
struct Touch {
  Separation separation;
  bool apart;  ///< By a gap that is too small to tell the direction from.
};

Touch touch(const Shape& a, const Shape& b, const Query& found, double gap) {
  constexpr double kRounding = 1e-14;  // [-] of the shapes' size: a proven gap below may be none.
  const double size = (a.origin() - b.origin()).norm() + a.extents().norm() + b.extents().norm() +
                      a.core_radius() + b.core_radius();
  Separation best = detail::best_separation(a, b, found.nearest);
  const bool apart = gap < kTouching && (best.gap > 0 || (found.proven && gap > kRounding * size));
  // Of two bounds the nearest points' is then the better.
  if (apart) best.gap = gap;
  return {best, apart};
}

}  // namespace

Clearance clearance(const Shape& a_W, const Shape& b_W) {
  const Query found = query(a_W, b_W);
  const Nearest& nearest = found.nearest;
  const double gap = std::sqrt(nearest.squared);
  if (is_apart(a_W, b_W, found, gap)) {
    return with_radii(a_W, b_W, nearest.p_BA_W / gap, gap, nearest.p_WCb);
  }
  const auto [best, apart] = touch(a_W, b_W, found, gap);
  const auto& [nhat_BA_W, depth] = best;
  if (apart) return with_radii(a_W, b_W, nhat_BA_W, depth, nearest.p_WCb);
  // Moved by the depth the cores just touch, and where they do are the witness points.
  const Eigen::Isometry3d X_WA(Eigen::Translation3d(-depth * nhat_BA_W));
  const Nearest there = query(a_W.in(X_WA), b_W).nearest;
  return with_radii(a_W, b_W, nhat_BA_W, depth, there.p_WCb + 0.5 * there.p_BA_W);
}

double distance(const Shape& a_W, const Shape& b_W) {
  const Query found = query(a_W, b_W);
  const double gap = std::sqrt(found.nearest.squared);
  if (is_apart(a_W, b_W, found, gap)) return gap - a_W.radius() - b_W.radius();
  return touch(a_W, b_W, found, gap).separation.gap - a_W.radius() - b_W.radius();
}

double distance_to_point(const Shape& a_W, const Vector3d& p_W) {
  expects(p_W.allFinite(), "distance_to_point: the point must be finite");
  const double gap = std::sqrt(nearest_to_point(p_W, a_W).squared);
  if (gap > kTouching) return gap - a_W.radius();
  return distance(Shape::sphere(p_W, 1)->padded(-1), a_W);
}

}  // namespace tandem::geometry
