#pragma once
/// Zero-clamped C2 cubic splines through waypoints.

#include <Eigen/Core>
#include <span>

#include "tandem/motion/joint_path.h"
#include "tandem/motion/piecewise_cubic.h"

namespace tandem::trajectory {

/// The spline through `waypoints` (N >= 2) with one free knot in the first and one in the last
/// interval: N + 2 knots, C2, velocity and acceleration zero at both ends.
/// @param durations  N + 1 knot intervals, > 0 [s].
/// Throws ContractViolation for wrong sizes or durations that are not positive.
/// Ref: docs/methods.md, "Zero-clamped C2 splines"; Wittmann, Rixen, Time-optimal trajectory
/// planning (2022).
motion::PiecewiseCubic fit_spline(const motion::JointPath& waypoints,
                                  std::span<const double> durations);

/// Knot index of waypoint i of `count` in the spline above.
inline int knot_of_waypoint(int i, int count) {
  return i == 0 ? 0 : i == count - 1 ? count + 1 : i + 1;
}

}  // namespace tandem::trajectory
