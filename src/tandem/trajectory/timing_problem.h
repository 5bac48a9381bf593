#pragma once
/// What every time optimiser shares: the limits as functions of the knot intervals.

#include <Eigen/Core>
#include <vector>

#include "tandem/trajectory/spline_system.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::trajectory {

/// Minimise sum h_k so that every ratio (value / limit) stays within [-1, 1] and every h_k above
/// the shortest interval. One thread at a time.
///
/// Ratios, by interval, kind and moving joint: the acceleration at the interval's first knot, one
/// velocity inside it and, where any joint limits jerk, its jerk. The velocity is taken at h |a_k|
/// / (|a_k| + |a_k+1|): the peak itself where the acceleration changes sign, and elsewhere a point
/// that moves into the next peak continuously, so that ratios are C1 in h and no constraint ever
/// appears or vanishes. The largest velocity of a zero-clamped C2 spline is one of these peaks.
class TimingProblem {
 public:
  /// Throws ContractViolation unless neighbouring waypoints differ and velocity and acceleration
  /// limits are positive and finite.
  TimingProblem(const motion::JointPath& waypoints, const std::vector<robot::JointLimits>& limits,
                const TimingOptions& options);

  Eigen::Index intervals() const { return spline_.intervals(); }
  double shortest_interval() const { return shortest_; }

  /// Fills ratios() at intervals h; false where the spline is singular to rounding.
  [[nodiscard]] bool evaluate(const Eigen::VectorXd& h);
  const Eigen::VectorXd& ratios() const { return ratios_; }
  /// Fills jacobian() = d ratios / d log h at the last evaluation.
  void differentiate();
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }

  /// Per interval, the factor by which it must be scaled for its own worst ratio at the last
  /// evaluation. Scaling all by the largest just obeys all limits.
  Eigen::VectorXd local_scales() const;
  double scale() const { return local_scales().maxCoeff(); }

  /// Intervals in proportion to the edges' own least times.
  Eigen::VectorXd initial_intervals() const;
  /// The same after a few rounds of stretching every interval by its own worst ratio: the best
  /// round, scaled to just obey all limits.
  Eigen::VectorXd stretched_intervals();

  /// A timing within all limits as limit_check sees them, from intervals that obey them nearly.
  Timing finish(Eigen::VectorXd h, int iterations) const;

 private:
  enum Kind : Eigen::Index { kAcceleration, kVelocity, kJerk };
  /// Velocity gained on the way to the peak inside an interval of length 1, and its slopes by the
  /// accelerations at both ends.
  struct Peak {
    double rise = 0, by_a = 0, by_next = 0;
  };
  static Peak peak_between(double p, double r);

  std::size_t peak_index(Eigen::Index k, Eigen::Index j) const {
    return static_cast<std::size_t>(k * spline_.joints() + j);
  }
  /// Entries of all joints for one kind of ratio in interval k, as a row.
  template <class Vector>
  auto rows(Vector&& v, Eigen::Index k, Kind kind) const {
    return v.segment((k * kinds_ + kind) * spline_.joints(), spline_.joints()).transpose();
  }

  const motion::JointPath& waypoints_;
  const std::vector<robot::JointLimits>& limits_;
  double shortest_;
  Eigen::RowVectorXd per_velocity_, per_acceleration_, per_jerk_;  ///< 1 / limit of moving joints.
  Eigen::Index kinds_ = 2;                                         ///< 3 where jerk is limited.
  SplineSystem spline_;
  Eigen::VectorXd ratios_;
  Eigen::MatrixXd jacobian_;
  std::vector<Peak> peaks_;
};

}  // namespace tandem::trajectory
