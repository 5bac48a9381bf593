#pragma once
/// Signed distance between convex shapes, with witness points and normal.

#include "tandem/geometry/shape.h"

namespace tandem::geometry {

/// Nearest approach of shapes A and B.
struct Clearance {
  double distance;            ///< [m] signed; negative is the depth, the least translation apart.
  Eigen::Vector3d nhat_BA_W;  ///< [-] unit; moving A along it increases `distance`.
  Eigen::Vector3d p_WCa;      ///< [m] witness point on the surface of A.
  Eigen::Vector3d p_WCb;      ///< [m] on B: p_WCa - p_WCb = distance * nhat_BA_W.
};

/// Clearance of two shapes in W, for every pair of core types.
/// Exact to rounding; with a convex core and of two cylinders to 1e-9 m apart (a convex core and a
/// cylinder: 1e-7 m) and 1e-6 m in penetration. Where cores touch or overlap, the normal is that of
/// least translation. Never fails; allocates only for such pairs whose cores overlap.
Clearance clearance(const Shape& a_W, const Shape& b_W);

/// `clearance(a_W, b_W).distance` alone [m], faster.
double distance(const Shape& a_W, const Shape& b_W);

/// Distance of a point, which must be finite, to a shape's surface [m], negative inside.
double distance_to_point(const Shape& a_W, const Eigen::Vector3d& p_W);

}  // namespace tandem::geometry
