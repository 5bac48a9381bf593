#pragma once
/// An independent check of a trajectory: dense samples by FCL on the URDF's own geometry.

#include <memory>
#include <string>
#include <vector>

#include "tandem/core/result.h"
#include "tandem/core/stop.h"
#include "tandem/motion/cell_motion.h"
#include "tandem/world/workcell.h"

namespace tandem::verification {

struct VerifyOptions {
  double rate = 1000;             ///< [Hz] > 0
  double limit_tolerance = 1e-6;  ///< Relative; absolute for positions [rad or m].
  /// Of position, velocity and acceleration over a knot, and against what is asked of the ends.
  double jump_tolerance = 1e-6;
};

struct VerifyReport {
  long samples = 0;
  double least_clearance = 0;  ///< [m] unpadded, over all samples; infinite without pairs.
  std::string nearest_pair;
  double nearest_time = 0;       ///< [s]
  double worst_limit_ratio = 0;  ///< Largest |value| / limit of velocity, acceleration and jerk.
  Eigen::Vector3d largest_jumps = Eigen::Vector3d::Zero();
  std::vector<std::string>
      failures;  ///< Empty if the plan is good; each says what, where, how much.
  bool ok() const { return failures.empty(); }
};

/// Shares no code with the planner's own proof: other geometry, other distances, samples instead of
/// bounds, every value straight from the coefficients. Samples are at multiples of 1 / rate and at
/// the end; limits are checked on both sides of every knot as well.
/// @param start, goal  where the motion must begin and end, with velocity and acceleration zero.
/// @return what FclChecker::make returns, the stop's error, or kInvalidInput if the motion or its
/// ends do not fit the cell or the rate is not positive.
Result<VerifyReport> verify(const std::shared_ptr<const world::Workcell>& cell,
                            const motion::CellMotion& motion, const Eigen::VectorXd& start,
                            const Eigen::VectorXd& goal, const VerifyOptions& options = {},
                            const StopCondition& stop = {});

}  // namespace tandem::verification
