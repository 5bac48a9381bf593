#pragma once
/// The derivatives of a motion q(c(t)) as polynomials, piece by piece.

#include <vector>

#include "tandem/math/bernstein.h"
#include "tandem/motion/cell_motion.h"

namespace tandem::trajectory {

/// Velocity, acceleration and jerk on one piece of an arm's motion, over its time as [0, 1]. With
/// s(t) the local time on the spline's segment and c1, c2, c3 the derivatives of c,
///
///   qd   = q1 [c1] + 2 q2 [s c1]             + 3 q3 [s^2 c1]
///   qdd  = q1 [c2] + 2 q2 [c1^2 + s c2]      + 3 q3 [2 s c1^2 + s^2 c2]
///   qddd = q1 [c3] + 2 q2 [3 c1 c2 + s c3]   + 3 q3 [2 c1^3 + 6 s c1 c2 + s^2 c3]
///
/// where q1, q2, q3 are a joint's coefficients on the segment and the brackets are those of all
/// joints: degree 8, 7 and 6 for cubic c. Ref: eq:cdot, eq:cddot.
class PieceDerivatives {
 public:
  /// @param motion  must outlive it.
  PieceDerivatives(const motion::ArmMotion& motion, const motion::ArmMotion::Piece& piece);

  /// @param order  1 to 3.   @param joint  of the arm.
  math::Bernstein operator()(int order, Eigen::Index joint) const;

 private:
  const motion::PiecewiseCubic& spline_;
  int segment_;                            ///< -1: the arm waits.
  std::vector<math::Bernstein> brackets_;  ///< Three per order.
};

}  // namespace tandem::trajectory
