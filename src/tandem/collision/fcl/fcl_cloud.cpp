#include "tandem/collision/fcl/fcl_cloud.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>

namespace tandem::collision {

using Eigen::Isometry3d;
using Eigen::Vector3d;

FclCloud::FclCloud(const geometry::PlacedSurface& cloud_L, double padding) {
  const double radius = cloud_L.surface->radius() + padding;
  point_ = make_piece(geometry::Shape::sphere(Vector3d::Zero(), radius).value());
  const auto ball = std::make_shared<fcl::Sphered>(radius);
  std::vector<fcl::CollisionObjectd*> objects;
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3d& p_S : cloud_L.surface->vertices()) {
    Isometry3d X_LG = Isometry3d::Identity();
    X_LG.translation() = cloud_L.X_FS * p_S;
    low = low.cwiseMin(X_LG.translation());
    high = high.cwiseMax(X_LG.translation());
    balls_L_.push_back(std::make_unique<fcl::CollisionObjectd>(ball, X_LG));
    objects.push_back(balls_L_.back().get());
  }
  box_L_ = {0.5 * (low + high), 0.5 * (high - low) + Vector3d::Constant(radius)};
  tree_.registerObjects(objects);
  tree_.setup();
}

void FclCloud::visit_near(const Isometry3d& X_LB, const Vector3d& half, double limit,
                          const std::function<double(const Isometry3d& X_LG)>& visit) const {
  struct Search {
    const std::function<double(const Isometry3d& X_LG)>& visit;
    double limit;
  } search{visit, limit};
  fcl::CollisionObjectd box(std::make_shared<fcl::Boxd>(2 * half), X_LB);
  const fcl::DistanceCallBack<double> callback =
      [](fcl::CollisionObjectd* ball, fcl::CollisionObjectd* query, void* data, double& least) {
        auto& [visit_ball, up_to] = *static_cast<Search*>(data);
        if (ball->getAABB().distance(query->getAABB()) < up_to || up_to <= 0) {
          up_to = visit_ball(ball->getTransform());
        }
        // Boxes that overlap are at distance 0, however deep: all of them are looked at.
        least = std::max(up_to, std::numeric_limits<double>::min());
        return false;
      };
  tree_.distance(&box, &search, callback);
}

}  // namespace tandem::collision
