#pragma once
/// Convex polytopes by their vertices and faces.

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::geometry {

/// The convex hull of points that do not lie on one line, in a frame H. Its origin is inside.
/// A flat hull, of points in one plane, is a polygon: its triangles come twice, once for each side.
struct ConvexHull {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< Counter-clockwise from outside.
  std::vector<std::array<int, 2>> edges;      ///< Of its faces, those within faces left out.
  std::vector<Eigen::Vector3d> normals;       ///< Unit, outward, one of each face.
  /// Neighbours along the triangles' sides: those of vertex i are
  /// neighbours[first_neighbour[i]], ..., neighbours[first_neighbour[i + 1] - 1].
  std::vector<int> first_neighbour, neighbours;
  bool flat = false;
  double volume = 0;           ///< [m^3]
  double surface = 0;          ///< [m^2]
  double mean_width_term = 0;  ///< [m] Half the sum of edge lengths times outer angles.
  /// Half axes u of an octahedron {+-u} in the hull about the origin, with volume if not flat.
  Eigen::Matrix3d inner = Eigen::Matrix3d::Zero();
  Eigen::Vector3d bounding_center = Eigen::Vector3d::Zero();
  double bounding_radius = 0;  ///< [m]

  /// The vertex furthest along `direction`.
  int support(const Eigen::Vector3d& direction) const;
};

/// Points as a hull sees them.
struct HullPoints {
  int dimension = 0;             ///< 0: one place, 1: a line, 2: a plane, 3.
  Eigen::Vector3d end_a, end_b;  ///< Of dimension 0 and 1: what lies furthest apart.
  Eigen::Vector3d center;        ///< Where H has its origin, else as in F.
  ConvexHull hull;               ///< Of dimension 2 and 3.
};

/// The hull of at least one point. Points within 1e-12 of their extent of a plane count as in it.
/// @return kInvalidInput if there are none, or one is not finite.
/// Ref: Barber, Dobkin, Huhdanpaa, The quickhull algorithm for convex hulls (1996).
Result<HullPoints> convex_hull(std::span<const Eigen::Vector3d> points);

}  // namespace tandem::geometry
