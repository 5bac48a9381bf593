#pragma once
/// Arms that are planned one after the other, each around those before it. Internal to pipeline/.

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/motion/joint_path.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

struct PrioritizedOptions {
  long most_samples = 20'000;  ///< Of the search of each arm, > 0.
};

/// A path of the whole cell: the first arm of `order` keeps its path, every further one is planned
/// with the fraction of the way of those before it as one more coordinate, so that they may go
/// slowly, wait or go back for it.
/// @param first  path of arm order[0] alone, from its start to its goal, its edges proven.
/// @param order  all arms of the cell.
/// @return proven edges; kNoPath, the stop's error. Equal seeds give equal paths.
/// Ref: docs/methods.md, "The ladder".
Result<motion::JointPath> plan_prioritized(const collision::CompiledCell& compiled,
                                           const ResolvedQuery& ends,
                                           const motion::JointPath& first,
                                           const std::vector<int>& order, std::uint64_t seed,
                                           const StopCondition& stop,
                                           const PrioritizedOptions& options = {});

}  // namespace tandem::pipeline
