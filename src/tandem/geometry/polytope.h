#pragma once
/// Nearest points of cores with corners, found feature by feature.

#include "tandem/geometry/orthotope.h"

namespace tandem::geometry::detail {

/// u x v with every component correct to about two roundings, however small the angle. Worth its
/// cost where a normal is needed: the naive one is noise for nearly parallel vectors.
Eigen::Vector3d accurate_cross(const Eigen::Vector3d& u, const Eigen::Vector3d& v);

/// A triangle with what its queries share.
struct Triangle {
  explicit Triangle(const Shape& shape);

  Eigen::Vector3d vertices[3];
  Segment edges[3];           ///< From vertex k to vertex k + 1.
  Eigen::Vector3d n;          ///< Normal, zero if the triangle has no area.
  double inverse_nn;          ///< 1 / |n|^2, or 0.
  Eigen::Vector3d inward[3];  ///< Normal to edge k, in the plane.

  /// Whether `p` lies over the inside of the triangle.
  bool is_over(const Eigen::Vector3d& p) const;
};

Nearest nearest_point_triangle(const Eigen::Vector3d& p, const Triangle& b);

/// The edges of a polytope core; of a point itself, of a cylinder its axis.
struct Edges {
  explicit Edges(const Shape& shape);

  const Segment* begin() const { return list; }
  const Segment* end() const { return list + count; }

  Segment list[12];
  int count = 0;
};

/// Nearest points of two cores out of segment (A only), triangle, rectangle and box, if the cores
/// are disjoint or only touch. Where they overlap it may miss that: check with `separation`.
Nearest nearest_features(const Shape& a, const Shape& b);

}  // namespace tandem::geometry::detail
