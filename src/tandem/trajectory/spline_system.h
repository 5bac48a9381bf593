#pragma once
/// The linear system behind a zero-clamped spline, and its derivatives by the knot intervals.

#include <Eigen/Core>

#include "tandem/math/tridiagonal.h"
#include "tandem/motion/joint_path.h"

namespace tandem::trajectory {

/// Knot positions, velocities and accelerations of the spline through N waypoints on N + 1
/// intervals h, for all joints at once: rows are knots (N + 2), columns are joints.
/// One thread at a time. Ref: docs/methods.md, "Zero-clamped C2 splines".
class SplineSystem {
 public:
  /// @param waypoints  N x joints, N >= 2.
  explicit SplineSystem(math::RowMatrix waypoints);

  Eigen::Index intervals() const { return waypoints_.rows() + 1; }
  Eigen::Index joints() const { return waypoints_.cols(); }

  /// False where intervals are so uneven that the system is singular to rounding.
  /// @param h  N + 1 knot intervals, > 0 [s].
  [[nodiscard]] bool solve(const Eigen::VectorXd& h);
  const Eigen::VectorXd& durations() const { return h_; }
  const math::RowMatrix& positions() const { return q_; }
  const math::RowMatrix& velocities() const { return v_; }
  const math::RowMatrix& accelerations() const { return a_; }

  /// Derivatives at the last solution, from A da/dh_l = db/dh_l - (dA/dh_l) a. Column
  /// l * joints() + j is the derivative of joint j by h_l.
  void differentiate();
  const math::RowMatrix& velocity_gradients() const { return dv_; }
  const math::RowMatrix& acceleration_gradients() const { return da_; }

 private:
  math::RowMatrix waypoints_;
  Eigen::VectorXd h_;
  math::RowMatrix q_, v_, a_, dv_, da_;
  math::TridiagonalLu factors_;
};

/// Waypoints as the rows of a matrix. Throws ContractViolation unless there are at least two, of
/// equal size and finite.
math::RowMatrix stacked(const motion::JointPath& waypoints);

}  // namespace tandem::trajectory
