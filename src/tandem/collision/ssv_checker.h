#pragma once
/// Collision checks on swept sphere volumes.

#include "tandem/collision/checker.h"

namespace tandem::collision {

struct SsvModel;

/// Bounding spheres first, then the cores. The scalar reference of the batch path.
class SsvChecker final : public CollisionChecker {
 public:
  explicit SsvChecker(std::shared_ptr<const world::Workcell> cell);
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
  /// linearising a distance needs between two walls. `out` is cleared first.
  void shape_clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                        const world::PairSelection& selection, double within,
                        CollisionChecker::Scratch& scratch, std::vector<PairClearance>& out) const;

  /// Places the cell at q; the pair queries below refer to it.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q, CollisionChecker::Scratch& scratch) const;
  /// Distance of one pair at the placed q, exact where it is below `needed`; where bounding
  /// spheres already prove more than `needed`, that lower bound.
  double pair_distance(int pair, double needed, CollisionChecker::Scratch& scratch) const;

  /// How far, at most, a point of a core of body `body` moves per unit motion of entry j of q, over
  /// all configurations inside the joint limits [m/rad or -]; 0 for joints that do not move it.
  /// The shapes swept around the cores come no further: a ball looks the same turned.
  /// Ref: docs/methods.md, "Continuous-time certificate".
  double lever_arm(int body, int j) const { return lever_arms_(body, j); }

  /// The compiled cell, for the certificate.
  const SsvModel& model() const { return *model_; }

 private:
  std::shared_ptr<const world::Workcell> cell_;
  std::unique_ptr<const SsvModel> model_;
  Eigen::MatrixXd lever_arms_;  // bodies x dof
};

}  // namespace tandem::collision
