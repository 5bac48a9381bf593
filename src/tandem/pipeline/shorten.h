#pragma once
/// The path length post-processor and what comes with it. Internal to pipeline/.

#include "tandem/pipeline/modules.h"

namespace tandem::pipeline {

struct ShortenContext {
  const collision::CompiledCell& compiled;
  const Modules& modules;
  const PlanOptions& options;
  StopCondition stop;
  PlanReport& report;
};

/// `path` with shorter tool paths, the same ends and edges that modules.validity accepts. With
/// Preset::kDefault never longer than `path` and never less clear than the shortener's clearance or
/// what it had; on a stop the best so far. With kPaper as the paper does it: interpolate to 20
/// waypoints, PLPP, simplify again, whatever comes out.
/// Adds the phases "interpolated", "shortened", "simplified_again", and f before and after.
/// Ref: the paper, "Path Length Minimization in SO(3)"; docs/methods.md, "PLPP".
motion::JointPath shorten_path(const ShortenContext& context, const ResolvedQuery& ends,
                               const motion::JointPath& path);

/// Lengths of every arm's tool path, measured at 20 or more waypoints each.
std::vector<ArmLengths> arm_lengths(const world::Workcell& cell, const motion::JointPath& before,
                                    const motion::JointPath& after);

}  // namespace tandem::pipeline
