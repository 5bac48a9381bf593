#include "tandem/geometry/cylinder_pair.h"

#include <cmath>

#include "tandem/geometry/cylinder.h"
#include "tandem/geometry/epa.h"
#include "tandem/geometry/gjk.h"

namespace tandem::geometry::detail {

using Eigen::Matrix3d, Eigen::Vector3d;

namespace {

/// Nearest points where the side or an end of one of the cylinders is touched inside its outline.
Nearest nearest_on_faces(const Shape& a, const Shape& b) {
  Nearest best;
  const auto keep_via = [&](const Vector3d& p_WCb) {
    keep_nearer(best, nearest_point_cylinder(p_WCb, a).swapped());
  };
  // The side of A: what is nearest to its axis.
  keep_via(nearest_segment_cylinder({a.origin(), a.extents().col(0)}, b).p_WCb);
  for (const double s : {1.0, -1.0}) {
    // An end of A: what reaches furthest towards it.
    keep_via(b.support(-s * a.extents().col(0)));
    // Parallel ends that overlap: on the line between their middles.
    const Vector3d middle = b.origin() + s * b.extents().col(0);
    keep_via(nearest_point_cylinder(nearest_point_cylinder(middle, a).p_WCb, b).p_WCb);
  }
  return best;
}

/// The point of A - B furthest against `direction`.
Vector3d near_point(const Shape& a, const Shape& b, const Vector3d& direction) {
  return a.support(-direction) - b.support(direction);
}

/// Newton's method for the direction along which rims are furthest apart, from a near one.
/// With p the near point, the gap nhat.p has the gradient p - gap nhat on the sphere and the
/// Hessian -(gap I + sum k t t'), t the tangent of each rim and k how fast its point turns.
Vector3d polished_direction(const Shape& a, const Shape& b, const Vector3d& start) {
  constexpr int kSteps = 20;
  constexpr double kTurned = 1e-15;  // [rad]
  Vector3d nhat = start, p = near_point(a, b, nhat);
  for (int i = 0; i < kSteps; ++i) {
    const double gap = nhat.dot(p);
    Matrix3d hessian = gap * Matrix3d::Identity();
    for (const Shape* shape : {&a, &b}) {
      const Vector3d t = shape->extents().col(0).cross(nhat);
      const double tt = t.squaredNorm(), sine = std::sqrt(tt * shape->inverse_squares()[0]);
      hessian += (shape->core_radius() / (sine * tt)) * t * t.transpose();
    }
    const Vector3d turn = hessian.inverse() * (p - gap * nhat);
    const Vector3d next = (nhat + turn).normalized(), next_p = near_point(a, b, next);
    if (!(next.dot(next_p) >= gap)) break;  // Also where nhat is along an axis, which has no rim.
    nhat = next;
    p = next_p;
    if (turn.squaredNorm() < kTurned * kTurned) break;
  }
  return nhat;
}

}  // namespace

Nearest nearest_cylinders(const Shape& a, const Shape& b) {
  constexpr double kSure = 1e-12;  // [m] Between the upper and lower bound of a closed form.
  Nearest best = nearest_on_faces(a, b);
  keep_nearer(best, nearest_on_faces(b, a).swapped());
  if (is_touch(best)) return best;
  const double upper = std::sqrt(best.squared);
  const double lower = best.p_BA_W.dot(near_point(a, b, best.p_BA_W)) / upper;
  if (upper - lower > kSure) keep_nearer(best, nearest_by_support(a, b));
  return best;
}

void search_rim_pairs(const Shape& a, const Shape& b, DirectionSearch& search) {
  const Separation best = expand_polytope(a, b, search.best());
  search.consider(best.nhat_BA_W);
  search.consider(polished_direction(a, b, best.nhat_BA_W));
}

}  // namespace tandem::geometry::detail
