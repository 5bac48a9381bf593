#pragma once
/// Centralized planning: all arms as one composite robot. Internal to pipeline/.

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// The executed curve, and the waypoints that it was made of.
struct PlannedMotion {
  motion::JointPath path;  ///< At least two.
  motion::CellMotion curve;
};

/// Path planning, simplification, shortening, then the executed curve. `ends` were checked. A cell
/// of one arm is planned the same way.
/// Ref: the paper, "Centralized Planning".
Result<PlannedMotion> plan_motion(const collision::CompiledCell& compiled,
                                  const ResolvedQuery& ends, const PlanOptions& options,
                                  const StopCondition& stop, PlanReport& report);

/// The same for a path that was found otherwise: simplification and what follows.
/// @param path  its edges proven, from start to goal.
Result<PlannedMotion> finish_path(const collision::CompiledCell& compiled,
                                  const ResolvedQuery& ends, motion::JointPath path,
                                  const PlanOptions& options, const StopCondition& stop,
                                  PlanReport& report);

}  // namespace tandem::pipeline
