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

/// Gap of the cores along `nhat` with its point of A - B, and how that turns with `nhat`.
struct Contact {
  Contact(const Shape& a, const Shape& b, const Vector3d& nhat)
      : p_WCb(b.support(nhat)), p_BA_W(a.support(-nhat) - p_WCb), gap(nhat.dot(p_BA_W)) {}

  Vector3d p_WCb, p_BA_W;
  double gap;
};

/// Newton's method for the direction along which rims are furthest apart, from a near one.
/// The gap's gradient on the sphere is p - gap nhat and its Hessian -(gap I + sum k t t'), with t
/// the tangent of each rim at its point and k how fast that point turns with nhat.
Vector3d polished_direction(const Shape& a, const Shape& b, const Vector3d& start) {
  constexpr int kSteps = 20;
  constexpr double kTurned = 1e-15;  // [rad]
  Vector3d nhat = start;
  double best = Contact(a, b, nhat).gap;
  for (int i = 0; i < kSteps; ++i) {
    const Contact contact(a, b, nhat);
    Matrix3d hessian = contact.gap * Matrix3d::Identity();
    for (const Shape* shape : {&a, &b}) {
      const Vector3d t = shape->extents().col(0).cross(nhat);
      const double tt = t.squaredNorm();
      if (!(tt > 0)) return nhat;
      const double sine = std::sqrt(tt * shape->inverse_squares()[0]);
      hessian += (shape->core_radius() / (sine * tt)) * t * t.transpose();
    }
    const Vector3d turn = hessian.inverse() * (contact.p_BA_W - contact.gap * nhat);
    if (!turn.allFinite()) break;
    const Vector3d next = (nhat + turn).normalized();
    const double gap = Contact(a, b, next).gap;
    if (!(gap >= best)) break;
    best = gap;
    nhat = next;
    if (turn.squaredNorm() < kTurned * kTurned) break;
  }
  return nhat;
}

}  // namespace

Nearest nearest_cylinders(const Shape& a, const Shape& b) {
  constexpr double kSure = 1e-12;      // [m] Between upper and lower bound of a closed form.
  constexpr double kTouching = 1e-20;  // [m^2] No direction is left.
  Nearest best = nearest_on_faces(a, b);
  keep_nearer(best, nearest_on_faces(b, a).swapped());
  const auto lower_bound = [&](const Nearest& nearest) {
    return nearest.p_BA_W.dot(Contact(a, b, nearest.p_BA_W).p_BA_W) / std::sqrt(nearest.squared);
  };
  if (best.squared < kTouching || std::sqrt(best.squared) - lower_bound(best) < kSure) return best;
  keep_nearer(best, nearest_by_support(a, b));
  if (best.squared < kTouching) return best;
  const Vector3d nhat = polished_direction(a, b, best.p_BA_W.normalized());
  const Contact contact(a, b, nhat);
  if (contact.gap > 0)
    keep_nearer(best, {contact.p_WCb, contact.p_BA_W, contact.p_BA_W.squaredNorm()});
  return best;
}

void search_rim_pairs(const Shape& a, const Shape& b, DirectionSearch& search) {
  const Separation best = expand_polytope(a, b, search.best());
  search.consider(best.nhat_BA_W);
  search.consider(polished_direction(a, b, best.nhat_BA_W));
}

}  // namespace tandem::geometry::detail
