#pragma once
/// Volumes in the making. Private to this folder.

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/shape.h"

namespace tandem::fitting {

/// Coordinates apart and in single precision: what is asked for a hundred thousand times.
struct Points {
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  void add(const Eigen::Vector3d& p) {
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
  }
  Eigen::Vector3d operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// A sphere, capsule, rounded rectangle or rounded box (0 to 3 `dims`) about an orthotope.
struct Core {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< Columns; the first `dims` have extent.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();      ///< [m] half extents; 0 from `dims` on.
  int dims = 1;
  double offset = 0;  ///< [m] a point belongs to the volume with the least distance - offset.
  double radius = 0;  ///< [m]

  /// Distance of a point to the core, without the radius [m].
  double distance(const Eigen::Vector3d& p) const;
  /// The same for many, but negative inside a box.   @param out  as many as points.
  void distances(const Points& points, std::vector<float>& out) const;
  /// With every extent below `least` [m] given up.
  Core simplified(double least) const;
  /// The core as the volumes file will hold it: 10 micrometres for positions and sizes.
  Core rounded() const;
  geometry::Shape shape() const;
};

/// A core about `points`: along their principal axes, or along those of their frame.
Core core_about(const std::vector<Eigen::Vector3d>& points, int dims, bool principal);

/// Raises radii, as little as it takes, until every triangle lies in the union: first for corners,
/// then for parts as in `prove_containment`.
/// @return the surface points for which something had to grow [m].
std::vector<Eigen::Vector3d> grow_to_contain(const geometry::TriangleMesh& mesh,
                                             std::vector<Core>& cores);

}  // namespace tandem::fitting
