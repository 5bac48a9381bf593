#pragma once
/// Smooth time maps through the places of a schedule.

#include <vector>

#include "tandem/coordination/coordinator.h"
#include "tandem/motion/time_map.h"

namespace tandem::coordination {

/// How local times run between the places of a schedule. Ref: the paper, "Continuous Control
/// Commands".
enum class Interpolation {
  kLinear,   ///< Straight: velocities jump at the places.
  kCubic,    ///< C2, accelerations zero at both ends.
  kQuintic,  ///< C4, velocities and accelerations zero at both ends.
};

const char* to_string(Interpolation interpolation);

/// One map per arm through all places at their times. Between places it may overshoot, beyond the
/// arm's duration as well, where what is beyond is cut off.
/// Throws ContractViolation for less than two places, unequal sizes or times that do not increase.
std::vector<motion::TimeMap> interpolate(const Schedule& schedule, Interpolation interpolation);

/// The values of one arm only, at `times`; the map through them as above.
motion::TimeMap interpolate(const std::vector<double>& times, const Eigen::VectorXd& values,
                            Interpolation interpolation);

}  // namespace tandem::coordination
