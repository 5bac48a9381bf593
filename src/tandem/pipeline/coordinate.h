#pragma once
/// From the arms' own motions to one of the whole cell. Internal to pipeline/.

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// Finds when which arm may be where by a preset's coordinator, and makes the executed motion of
/// it: q(c(t)) within the limits, with a certificate.
/// @param arms    by arm, each proven alone.
/// @param report  gets times, rungs, and the least clearance of pairs that two arms move.
/// @return kCoordination naming what blocks; kCollision if the executed motion touches something
/// and nothing is repaired; kInfeasible, the stop's error.
Result<motion::CellMotion> coordinate(const collision::CompiledCell& compiled,
                                      std::vector<motion::PiecewiseCubic> arms,
                                      const PlanOptions& options, const StopCondition& stop,
                                      PlanReport& report);

}  // namespace tandem::pipeline
