#pragma once
/// Collision checks on swept sphere volumes, meshes and clouds.

#include "tandem/collision/checker.h"

namespace tandem::collision {

struct SsvModel;

/// Trees of bounding spheres first, then the cores. The scalar reference of the batch path.
/// Ref: docs/methods.md, "Swept sphere volumes".
class SsvChecker final : public CollisionChecker {
 public:
  /// @param like  of the same cell in another state, or of one with the same robots: bodies that
  ///   are the same are not compiled anew.
  explicit SsvChecker(std::shared_ptr<const world::Workcell> cell,
                      const SsvChecker* like = nullptr);
  ~SsvChecker() override;

  const world::Workcell& cell() const override { return *cell_; }
  std::unique_ptr<CollisionChecker::Scratch> make_scratch() const override;
  bool is_free(const Eigen::Ref<const Eigen::VectorXd>& q, const world::PairSelection& selection,
               CollisionChecker::Scratch& scratch) const override;
  PairClearance least_clearance(const Eigen::Ref<const Eigen::VectorXd>& q,
                                const world::PairSelection& selection,
                                CollisionChecker::Scratch& scratch) const override;
  void clearances(const Eigen::Ref<const Eigen::VectorXd>& q, const world::PairSelection& selection,
                  double within, CollisionChecker::Scratch& scratch,
                  std::vector<PairClearance>& out) const override;

  /// All pairs of shapes nearer than `within` [m], several to a pair of bodies where they are: what
  /// linearising a distance needs between two walls. Of pieces of a surface that lie in about the
  /// same direction from a shape only the nearest. `out` is cleared first.
  void shape_clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                        const world::PairSelection& selection, double within,
                        CollisionChecker::Scratch& scratch, std::vector<PairClearance>& out) const;

  /// Places the cell at q; the pair queries below refer to it.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q, CollisionChecker::Scratch& scratch) const;
  /// Distance of one pair at the placed q, exact where it is below `needed`; where bounding
  /// spheres already prove more than `needed`, that lower bound.
  double pair_distance(int pair, double needed, CollisionChecker::Scratch& scratch) const;

  /// The compiled cell, for the certificate.
  const SsvModel& model() const { return *model_; }

 private:
  std::shared_ptr<const world::Workcell> cell_;
  std::unique_ptr<const SsvModel> model_;
};

}  // namespace tandem::collision
