#pragma once
/// Path planning and simplification by a preset's modules. Internal to pipeline/.

#include "tandem/pipeline/modules.h"

namespace tandem::pipeline {

/// Plans and simplifies, and fills times, counts and (if options.keep_phases) phases of `report`.
/// The planner checks the ends. @return the planner's errors.
Result<PathPlan> find_path(const collision::CompiledCell& compiled, const Modules& modules,
                           const ResolvedQuery& ends, const PlanOptions& options,
                           const StopCondition& stop, PlanReport& report);

/// The second half of it: `planned` and what the simplifier makes of it.
PathPlan simplified(const collision::CompiledCell& compiled, const Modules& modules,
                    const ResolvedQuery& ends, motion::JointPath planned,
                    const PlanOptions& options, const StopCondition& stop, PlanReport& report);

/// find_path for all arms; an infeasible end is explained by check_ends.
Result<PathPlan> find_path(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
                           const PlanOptions& options, PlanReport& report);

/// See certify_path in plan.h.
Result<double> certify_path(const collision::CompiledCell& compiled, const motion::JointPath& path,
                            const StopCondition& stop);

/// Copies what the validity has counted into the report.
void account(const Modules& modules, PlanReport& report);

/// See check_ends in plan.h.
Result<void> check_ends(const collision::CompiledCell& compiled, const ResolvedQuery& query);

}  // namespace tandem::pipeline
