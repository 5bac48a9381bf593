#pragma once
/// The interface of every collision checker.

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::collision {

/// Nearest approach of one pair of bodies.
struct PairClearance {
  int pair = -1;  ///< Index into Workcell::pairs(); -1 if there was no pair.
  /// [m] signed, padding included; +infinity if there was no pair. Depths in meshes are lower
  /// bounds of the least translation apart.
  double distance = 0;
  Eigen::Vector3d nhat_BA_W = Eigen::Vector3d::UnitZ();  ///< Moving A along it raises distance.
  Eigen::Vector3d p_WCa = Eigen::Vector3d::Zero();       ///< Witness points on the padded bodies.
  Eigen::Vector3d p_WCb = Eigen::Vector3d::Zero();
};

/// Immutable and thread-safe; what changes lives in a Scratch, one per thread.
/// Touching (distance 0) counts as in collision, and so does what lies inside a closed mesh.
class CollisionChecker {
 public:
  class Scratch {
   public:
    virtual ~Scratch() = default;
  };

  virtual ~CollisionChecker() = default;
  virtual const world::Workcell& cell() const = 0;
  virtual std::unique_ptr<Scratch> make_scratch() const = 0;

  /// Whether all pairs of `selection` are apart at q (cell().dof()).
  virtual bool is_free(const Eigen::Ref<const Eigen::VectorXd>& q,
                       const world::PairSelection& selection, Scratch& scratch) const = 0;
  /// The pair with the least signed distance.
  virtual PairClearance least_clearance(const Eigen::Ref<const Eigen::VectorXd>& q,
                                        const world::PairSelection& selection,
                                        Scratch& scratch) const = 0;
  /// All pairs nearer than `within` [m], in order of the selection; `out` is cleared first.
  virtual void clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                          const world::PairSelection& selection, double within, Scratch& scratch,
                          std::vector<PairClearance>& out) const = 0;
};

/// d distance / d q of one clearance found at q: nhat^T (J_a - J_b) at the witness points.
/// @param X_WL  link poses at q.   @param gradient  cell.dof(), overwritten [m/rad or -].
/// Ref: docs/methods.md, "Swept sphere volumes".
void distance_gradient(const world::Workcell& cell, const robot::LinkPoses& X_WL,
                       const PairClearance& clearance, Eigen::Ref<Eigen::VectorXd> gradient);

/// "left/panda_hand and box_wall_1, 0.012 m deep" or "... 0.012 m apart".
std::string describe(const world::Workcell& cell, const PairClearance& clearance);

}  // namespace tandem::collision
