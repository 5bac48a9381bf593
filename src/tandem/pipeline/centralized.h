#pragma once
/// Centralized planning: all arms as one composite robot. Internal to pipeline/.

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// Path planning, simplification, then the executed curve. `ends` were checked.
/// Ref: the paper, "Centralized Planning".
Result<Plan> plan_centralized(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
                              const PlanOptions& options, const StopCondition& stop,
                              PlanReport& report);

}  // namespace tandem::pipeline
