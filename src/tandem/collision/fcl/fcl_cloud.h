#pragma once
/// Private to this folder: a point cloud as FCL sees it.

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <functional>

#include "tandem/collision/fcl/fcl_geometry.h"
#include "tandem/geometry/surface.h"

namespace tandem::collision {

/// Balls that are fixed on a link, in FCL's tree of boxes. Immutable.
class FclCloud {
 public:
  FclCloud(const geometry::PlacedSurface& cloud_L, double padding);

  /// One of its points, to be placed at the origin of X_WG of `visit_near`.
  const FclPiece& point() const { return point_; }
  /// Box around it, in L.
  const FclBox& box_L() const { return box_L_; }
  const std::vector<std::unique_ptr<fcl::CollisionObjectd>>& balls_L() const { return balls_L_; }

  /// Calls visit(X_LG) for balls that may be nearer than `limit` to a box, the nearest first.
  /// @param X_LB  pose of the box; its edges are 2 * half [m].
  /// @param visit  -> the limit from here on.
  void visit_near(const Eigen::Isometry3d& X_LB, const Eigen::Vector3d& half, double limit,
                  const std::function<double(const Eigen::Isometry3d& X_LG)>& visit) const;

 private:
  FclPiece point_;
  FclBox box_L_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> balls_L_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

}  // namespace tandem::collision
