#pragma once
/// Measures of what volumes add to a solid. Private to this folder.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/shape.h"

namespace tandem::fitting {

/// Axis-aligned.
struct Bounds {
  Eigen::Vector3d low, high;

  static Bounds of(const geometry::TriangleMesh& mesh);
  static Bounds of(std::span<const geometry::Shape> volumes);
  double diagonal() const { return (high - low).norm(); }
  double volume() const { return (high - low).prod(); }
};

/// What a mesh encloses: the points about which it winds more than half. For a closed mesh that is
/// its inside, whichever way its triangles turn; for an open or torn one the best guess.
/// Ref: Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside segmentation using generalized
/// winding numbers, 2013.
class Solid {
 public:
  explicit Solid(const geometry::TriangleMesh& mesh);

  bool contains(const Eigen::Vector3d& p) const;
  bool is_closed() const { return closed_; }
  double area() const { return area_; }  ///< [m^2] of the surface.
  /// Distance of a point to the surface [m].
  double distance(const Eigen::Vector3d& p) const;

 private:
  struct Facet {
    Eigen::Vector3d a, b, c;
    Eigen::Vector3d center;
    Eigen::Vector3d n;  ///< Normal, as long as the area [m^2].
    double radius;      ///< Of a sphere about `center` that contains it.
  };
  std::vector<Facet> facets_;
  bool closed_ = false;
  double area_ = 0;
};

/// What volumes do to a solid, by seeded samples.
struct Excess {
  double solid = 0;       ///< [m^3] of the solid.
  double outside = 0;     ///< [m^3] of the union of the volumes that lies outside the solid.
  double protrusion = 0;  ///< [m] largest distance of the volumes' surface from the mesh.
};
Excess measure(const Solid& solid, const Bounds& bounds, std::span<const geometry::Shape> volumes,
               Rng& rng);

/// Entry `index` (from 1) of a low-discrepancy sequence in the unit cube.
/// Ref: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
Eigen::Vector3d spread_point(std::size_t index);

}  // namespace tandem::fitting
