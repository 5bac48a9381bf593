#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tandem/collision/fcl/fcl_geometry.h"

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// n's gap between two solids: how far apart the planes normal to n are that support them. The
/// signed distance is the widest gap of all n, so every gap bounds it from below.
double gap(const FclPiece& a, const Isometry3d& X_WA, const FclPiece& b, const Isometry3d& X_WB,
           const Vector3d& n_W) {
  const Vector3d p_Wa = X_WA * a.support(-(X_WA.linear().transpose() * n_W));
  const Vector3d p_Wb = X_WB * b.support(X_WB.linear().transpose() * n_W);
  return n_W.dot(p_Wa - p_Wb);
}

/// Depth of solids that overlap, by the separating axes; exact for polytopes. A cylinder adds FCL's
/// own normal; then the depth may be too large.
CoreDistance solid_depth(const FclPiece& a, const Isometry3d& X_WA, const FclPiece& b,
                         const Isometry3d& X_WB) {
  CoreDistance best;
  const auto attempt = [&](const Vector3d& n_W) {
    for (const Vector3d& n : {n_W, Vector3d(-n_W)}) {
      const double width = gap(a, X_WA, b, X_WB, n);
      if (!(width > best.distance)) continue;
      best.distance = width;
      best.nhat_BA_W = n;
    }
  };
  for (const Vector3d& n_G : a.normals_G) attempt(X_WA.linear() * n_G);
  for (const Vector3d& n_G : b.normals_G) attempt(X_WB.linear() * n_G);
  for (const Vector3d& e_Ga : a.edges_G) {
    for (const Vector3d& e_Gb : b.edges_G) {
      const Vector3d n = (X_WA.linear() * e_Ga).cross(X_WB.linear() * e_Gb);
      if (n.norm() > 1e-9) attempt(n.normalized());
    }
  }
  const fcl::CollisionRequestd request(1, true);
  fcl::CollisionResultd result;
  fcl::collide(a.solid.get(), X_WA, b.solid.get(), X_WB, request, result);
  Vector3d p_W = X_WA * a.points_G.front();
  if (result.numContacts() > 0) {
    const fcl::Contactd& contact = result.getContact(0);
    if (contact.normal.norm() > 0) attempt(contact.normal.normalized());
    p_W = contact.pos;
  }
  best.p_Wa = p_W + 0.5 * best.distance * best.nhat_BA_W;
  best.p_Wb = p_W - 0.5 * best.distance * best.nhat_BA_W;
  return best;
}

/// B's pose moved by so little that no answer changes, but that ties break.
Isometry3d nudged(const Isometry3d& X_WB, int attempt) {
  if (attempt == 0) return X_WB;
  const double size = 1e-8 * std::pow(4.0, attempt);
  const Vector3d direction(0.36, 0.48 * std::cos(attempt), 0.8 * std::sin(attempt));
  Isometry3d X = X_WB;
  X.linear() = Eigen::AngleAxisd(size, direction.normalized()) * X.linear();
  X.translation() += size * direction.reverse();
  return X;
}

/// Whether a point is enclosed by a surface, closed or nearly so.
/// Ref: Jacobson et al., Robust inside-outside segmentation using generalized winding numbers
/// (2013).
bool encloses(const FclPiece& piece, const Vector3d& p_G) {
  const auto& mesh = static_cast<const fcl::BVHModel<fcl::OBBRSSd>&>(*piece.surface);
  if ((p_G.array() < mesh.aabb_local.min_.array()).any() ||
      (p_G.array() > mesh.aabb_local.max_.array()).any()) {
    return false;
  }
  double solid_angle = 0;
  for (int i = 0; i < mesh.num_tris; ++i) {
    const fcl::Triangle& t = mesh.tri_indices[i];
    const Vector3d a = mesh.vertices[t[0]] - p_G, b = mesh.vertices[t[1]] - p_G,
                   c = mesh.vertices[t[2]] - p_G;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2 * std::atan2(a.dot(b.cross(c)),
                                  la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(solid_angle) > 2 * std::numbers::pi;
}

/// Whether a part of `inner` is enclosed by `outer`, if their surfaces do not touch.
bool encloses(const FclPiece& outer, const Isometry3d& X_WO, const FclPiece& inner,
              const Isometry3d& X_WI) {
  if (outer.is_hollow) return false;
  const Isometry3d X_OI = X_WO.inverse() * X_WI;
  return std::ranges::any_of(inner.points_G,
                             [&](const Vector3d& p_I) { return encloses(outer, X_OI * p_I); });
}

/// FCL's estimate for surfaces that intersect: the deepest of its contacts.
CoreDistance surface_depth(const FclPiece& a, const Isometry3d& X_WA, const FclPiece& b,
                           const Isometry3d& X_WB) {
  constexpr std::size_t kMostContacts = 64;
  const fcl::CollisionRequestd request(kMostContacts, true);
  fcl::CollisionResultd result;
  fcl::collide(a.surface.get(), X_WA, b.surface.get(), X_WB, request, result);
  const Vector3d p_W = X_WA * a.points_G.front();
  CoreDistance deepest{0, Vector3d::UnitZ(), p_W, p_W};
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    const fcl::Contactd& contact = result.getContact(i);
    if (contact.penetration_depth < -deepest.distance) continue;
    deepest.distance = -contact.penetration_depth;
    if (contact.normal.norm() > 0) deepest.nhat_BA_W = -contact.normal.normalized();
    deepest.p_Wa = deepest.p_Wb = contact.pos;
  }
  deepest.p_Wa += 0.5 * deepest.distance * deepest.nhat_BA_W;
  deepest.p_Wb -= 0.5 * deepest.distance * deepest.nhat_BA_W;
  return deepest;
}

}  // namespace

// FCL's solver for solids ends early where supports tie, as they do in every cell of aligned boxes,
// with points that are far from the nearest ones (seen: 0.3 m). So its normal must prove its
// distance; where it does not, the question is put again with a pose nudged out of the tie.
CoreDistance solid_distance(const FclPiece& a, const Isometry3d& X_WA, const FclPiece& b,
                            const Isometry3d& X_WB, double limit) {
  constexpr int kAttempts = 9;
  constexpr double kAgreement = 1e-6;      // Of distance and gap [m].
  constexpr double kGjkTolerance = 1e-12;  // FCL's default leaves 1e-3 rad on cylinders.
  const fcl::DistanceRequestd request(true, false, 0, 0, kGjkTolerance, fcl::GST_LIBCCD);
  CoreDistance best;
  for (int i = 0; i < kAttempts; ++i) {
    fcl::DistanceResultd result;
    fcl::distance(a.solid.get(), X_WA, b.solid.get(), nudged(X_WB, i), request, result);
    const Vector3d p_BA = result.nearest_points[0] - result.nearest_points[1];
    const double apart = p_BA.norm();
    if (!(result.min_distance > 0 && apart > 0)) return solid_depth(a, X_WA, b, X_WB);
    const Vector3d nhat = p_BA / apart;
    const double width = gap(a, X_WA, b, X_WB, nhat);
    if (width > best.distance) {
      best = {width, nhat, result.nearest_points[0], result.nearest_points[1]};
    }
    if (best.distance >= limit || apart - best.distance < kAgreement) break;
  }
  return best;
}

CoreDistance surface_distance(const FclPiece& a, const Isometry3d& X_WA, const FclPiece& b,
                              const Isometry3d& X_WB, double limit) {
  const bool enclosed = encloses(a, X_WA, b, X_WB) || encloses(b, X_WB, a, X_WA);
  const fcl::DistanceRequestd request(true);
  // FCL takes a distance that is not positive for an answer.
  fcl::DistanceResultd result(enclosed ? kInfinity
                                       : std::max(limit, std::numeric_limits<double>::min()));
  fcl::distance(a.surface.get(), X_WA, b.surface.get(), X_WB, request, result);
  if (!(result.min_distance > 0)) return surface_depth(a, X_WA, b, X_WB);
  CoreDistance core{result.min_distance, Vector3d::UnitZ(), result.nearest_points[0],
                    result.nearest_points[1]};
  if (!enclosed && core.distance >= limit) {  // Then there are no nearest points.
    core.distance = kInfinity;
    return core;
  }
  const Vector3d p_BA = core.p_Wa - core.p_Wb;
  if (p_BA.norm() > 0) core.nhat_BA_W = p_BA.normalized();
  if (enclosed) {  // At least as deep as the surfaces are apart.
    core.distance = -core.distance;
    core.nhat_BA_W = -core.nhat_BA_W;
  }
  return core;
}

}  // namespace tandem::collision
