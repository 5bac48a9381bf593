#pragma once
/// Exact limit check of a motion.

#include <string>
#include <vector>

#include "tandem/core/result.h"
#include "tandem/motion/cell_motion.h"
#include "tandem/robot/model.h"

namespace tandem::trajectory {

/// Largest absolute values over the whole motion, per joint; exact (knots, segment ends and the
/// stationary points of every cubic).
struct Extremes {
  Eigen::VectorXd lowest, highest;               ///< Position.
  Eigen::VectorXd velocity, acceleration, jerk;  ///< Largest absolute value.
};
Extremes extremes(const motion::PiecewiseCubic& motion);
/// Of q(c(t)): positions over all local times between the least and the largest c, exact; the rest
/// values that are reached, and no peak is missed by more than 1e-9 of it.
Extremes extremes(const motion::ArmMotion& motion);
Extremes extremes(const motion::CellMotion& motion);

enum class LimitKind { kPosition, kVelocity, kAcceleration, kJerk };

struct LimitViolation {
  int joint = -1;
  LimitKind kind = LimitKind::kPosition;
  double value = 0, limit = 0;
};

/// Violations beyond `tolerance` (relative to the limit; absolute for positions), worst first. With
/// tolerance 0 the comparison is exact: a value equal to its limit is no violation.
std::vector<LimitViolation> check_limits(const Extremes& extremes,
                                         const std::vector<robot::JointLimits>& limits,
                                         double tolerance = 1e-6);
template <class AnyMotion>
std::vector<LimitViolation> check_limits(const AnyMotion& motion,
                                         const std::vector<robot::JointLimits>& limits,
                                         double tolerance = 1e-6) {
  return check_limits(extremes(motion), limits, tolerance);
}

/// "velocity of left/panda_joint2 reaches 2.3, its limit is 2.175 [rad/s or m/s]"
std::string describe(const LimitViolation& violation, const std::vector<std::string>& joint_names);

/// Factor by which time must be stretched so that velocity, acceleration and jerk hold (1 = just).
double stretch_factor(const Extremes& extremes, const std::vector<robot::JointLimits>& limits);

}  // namespace tandem::trajectory
