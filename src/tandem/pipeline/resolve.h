#pragma once
/// From goals to joint values. Internal to pipeline/.

#include "tandem/pipeline/planner.h"

namespace tandem::pipeline {

/// See `resolve` and `resolve_all` in plan.h; the planner's cell, and its compiled cells.
Result<ResolvedQuery> resolve_query(const Planner& planner, const world::Query& query,
                                    std::uint64_t seed, const StopCondition& stop);
Result<std::vector<ResolvedQuery>> resolve_queries(const Planner& planner,
                                                   const std::vector<world::Query>& queries,
                                                   std::uint64_t seed, const StopCondition& stop);

}  // namespace tandem::pipeline
