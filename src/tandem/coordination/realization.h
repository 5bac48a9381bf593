#pragma once
/// From a schedule to the motion that is executed.

#include <optional>

#include "tandem/coordination/coordinator.h"
#include "tandem/coordination/interpolation.h"
#include "tandem/motion/cell_motion.h"
#include "tandem/trajectory/limit_check.h"

namespace tandem::coordination {

/// A schedule that a robot can follow.
struct Realization {
  motion::CellMotion motion;  ///< q(c(t)) of every arm.
  /// Every pair between arms keeps at least this distance [m], padding included.
  double least_clearance = 0;
  int repairs = 0;           ///< Places added because the motion left the schedule too far.
  bool stop_and_go = false;  ///< Whether it ended with stops at all places of the schedule.
  long evaluations = 0;      ///< Configurations placed for the proof.
};

struct RealizationOptions {
  int repair_rounds = 12;  ///< Before every edge is run from rest to rest, >= 0.
};

/// Cubic maps through the schedule's places, at intervals as short as the joint limits allow: an
/// arm may run faster than planned where its limits have slack. The motion is proven between all
/// arms; where the proof fails, places are added on the schedule's polyline, and if that does not
/// end, the arms follow the polyline from stop to stop. So it fails on a proven schedule only where
/// that has no more than about a micrometre to spare. Ref: docs/methods.md, "Coordination".
/// @param problem   its motions are at rest at both ends and within the limits.
/// @param schedule  from all starts to all ends, every edge proven.
/// @return kCollision naming pair, time and depth, or the stop's error.
Result<Realization> realize(const CoordinationProblem& problem, const Schedule& schedule,
                            collision::BatchChecker::Scratch& scratch,
                            const StopCondition& stop = {}, const RealizationOptions& options = {});

/// All arms at once, as long as the slowest takes alone: slowed down to that, or at planned speed
/// with waits at their ends; whichever is proven free. No motion is shorter.
/// @param problem  as above.
/// @return nothing if neither is, or if it was stopped.
std::optional<Realization> realize_at_once(const CoordinationProblem& problem,
                                           collision::BatchChecker::Scratch& scratch,
                                           const StopCondition& stop = {});

/// One arm after the other at planned speed, in the first order that is proven free, of 120 at
/// most.
/// @return nothing if none is, or if it was stopped.
std::optional<Realization> realize_in_sequence(const CoordinationProblem& problem,
                                               collision::BatchChecker::Scratch& scratch,
                                               const StopCondition& stop = {});

/// A schedule interpolated as it is, and what that motion was found to do.
struct Interpolated {
  motion::CellMotion motion;
  collision::Certificate certificate;                  ///< Of the pairs between arms.
  std::vector<trajectory::LimitViolation> violations;  ///< Worst first, joints of the cell.
  double stretch = 1;  ///< By which time must be stretched so that no limit is broken, >= 1.
};

/// Nothing is stretched or repaired: Ref: the paper, "Continuous Control Commands".
/// @return the stop's error.
Result<Interpolated> interpolate_unrepaired(const CoordinationProblem& problem,
                                            const Schedule& schedule, Interpolation interpolation,
                                            collision::CollisionChecker::Scratch& scratch,
                                            const StopCondition& stop = {});

}  // namespace tandem::coordination
