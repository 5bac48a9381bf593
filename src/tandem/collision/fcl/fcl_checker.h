#pragma once
/// Collision checks by FCL: the independent reference.

#include "tandem/collision/checker.h"
#include "tandem/core/result.h"

namespace tandem::collision {

enum class FclGeometry {
  kVolumes,  ///< The bodies' shapes and surfaces, padded.
  kUrdf,     ///< The links' collision geometry as in the URDF; obstacles and attached objects from
             ///< their shapes and surfaces; nothing padded.
};

/// Same answers as SsvChecker on kVolumes: distances, and depths of all but cylinders, to 1e-5 m; a
/// cylinder's depth is never too small. What lies inside a closed mesh is in collision with it; the
/// depth in a mesh is an estimate, and against a mesh a cylinder is a prism of 128 sides around it.
class FclChecker final : public CollisionChecker {
 public:
  /// @return kNotFound or kIo naming the link and file if a mesh cannot be read; kUnsupported if a
  /// robot link has volumes but no URDF collision geometry and kUrdf is asked for.
  static Result<std::unique_ptr<FclChecker>> make(std::shared_ptr<const world::Workcell> cell,
                                                  FclGeometry geometry);
  ~FclChecker() override;

  const world::Workcell& cell() const override;
  std::unique_ptr<CollisionChecker::Scratch> make_scratch() const override;
  bool is_free(const Eigen::Ref<const Eigen::VectorXd>& q, const world::PairSelection& selection,
               CollisionChecker::Scratch& scratch) const override;
  PairClearance least_clearance(const Eigen::Ref<const Eigen::VectorXd>& q,
                                const world::PairSelection& selection,
                                CollisionChecker::Scratch& scratch) const override;
  void clearances(const Eigen::Ref<const Eigen::VectorXd>& q, const world::PairSelection& selection,
                  double within, CollisionChecker::Scratch& scratch,
                  std::vector<PairClearance>& out) const override;

 private:
  struct Impl;
  explicit FclChecker(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tandem::collision
