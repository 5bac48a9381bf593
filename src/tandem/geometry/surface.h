#pragma once
/// Triangle meshes and point clouds as geometry: many small convex pieces.

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "tandem/geometry/bounding_tree.h"
#include "tandem/geometry/shape.h"

namespace tandem::geometry {

/// A triangle mesh or a point cloud in its own frame S; every piece (triangle or point) is swept by
/// `radius`. Immutable; share it. A closed mesh is solid: its inside counts as occupied.
class Surface {
 public:
  /// @param vertices_S  [m]   @param triangles  indices into them.   @param radius [m], >= 0.
  /// Triangles without area are left out.
  /// @return kInvalidInput naming the triangle or vertex: an index out of range, a value that is
  /// not finite, nothing left.
  static Result<std::shared_ptr<const Surface>> mesh(std::vector<Eigen::Vector3d> vertices_S,
                                                     std::vector<std::array<int, 3>> triangles,
                                                     double radius = 0);
  /// @param points_S  [m], at least one.   @param radius  [m], > 0: half the points' spacing.
  static Result<std::shared_ptr<const Surface>> cloud(std::vector<Eigen::Vector3d> points_S,
                                                      double radius);

  bool is_mesh() const { return !triangles_.empty(); }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  double radius() const { return radius_; }

  int piece_count() const {
    return static_cast<int>(is_mesh() ? triangles_.size() : vertices_.size());
  }
  /// A rounded triangle (its radius may be 0) or a sphere, swept by `padding` more [m].
  Shape piece(int index, double padding = 0) const;

  /// Whether every edge has one triangle on either side, all facing the same way, so that there is
  /// an inside. Vertices at one place count as one.
  bool is_closed() const { return !solid_.empty(); }
  /// Whether a point lies inside a closed mesh (without its radius); false for every other surface.
  /// On the surface, to rounding, it may be either. A ray's crossings, in about O(log n).
  bool contains(const Eigen::Vector3d& p_S) const;

 private:
  Surface() = default;

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  double radius_ = 0;
  // Of a closed mesh: its triangles with those without area, joined where vertices are equal.
  std::vector<std::array<int, 3>> solid_;
  BoundingTree solid_tree_;
};

/// A surface somewhere in a frame F.
struct PlacedSurface {
  std::shared_ptr<const Surface> surface;
  Eigen::Isometry3d X_FS = Eigen::Isometry3d::Identity();
};

}  // namespace tandem::geometry
