#pragma once
/// Arms that move along one parameter.

#include "tandem/coordination/coordinator.h"

namespace tandem::coordination {

/// Some arms along a schedule of their own, or one arm along its motion. The parameter is the
/// schedule's time. Immutable and thread-safe.
class Track {
 public:
  /// One arm of the problem.   @param problem  must outlive the track.
  Track(const CoordinationProblem& problem, int arm);
  /// @param schedule  its places have one local time per entry of `arms`.
  Track(const CoordinationProblem& problem, std::vector<int> arms, Schedule schedule);

  const std::vector<int>& arms() const { return arms_; }
  world::ArmMask mask() const { return mask_; }
  double duration() const { return schedule_.times.back(); }  ///< [s]
  const Schedule& schedule() const { return schedule_; }
  /// Local times of its arms at parameter `t`, clamped.
  Eigen::VectorXd place(double t) const;
  /// Parameters strictly between t0 and t1 at which the place changes its direction, ascending.
  std::vector<double> kinks(double t0, double t1) const;

  /// A box that contains the configurations of the track's arms for all t in [t0, t1]: writes their
  /// entries of `center` and `D`, which have those of the whole cell, and leaves the others.
  void box(double t0, double t1, Eigen::VectorXd& center, Eigen::VectorXd& D) const;

 private:
  const CoordinationProblem& problem_;
  std::vector<int> arms_;
  world::ArmMask mask_ = 0;
  Schedule schedule_;
};

}  // namespace tandem::coordination
