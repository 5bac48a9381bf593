#pragma once
/// From waypoints to the executed curve: timing, proof, repair. Internal to pipeline/.

#include "tandem/collision/batch_certificate.h"
#include "tandem/pipeline/modules.h"

namespace tandem::pipeline {

struct CurveContext {
  const collision::CompiledCell& compiled;
  bool by_batches;  ///< Whether batches prove what they can, or the exact certificate does it all.
  const trajectory::TimeOptimizer& timing;
  StopCondition stop;
  PlanReport& report;
};

/// Times `path` and proves the curve: continuous-time certificate and exact limits.
///
/// With `repair`, a curve that leaves its polyline too far gets waypoints on the straight edges
/// where it failed and is timed again; if that does not end, every edge is run from rest to rest,
/// which follows the polyline exactly. So it fails on a certified polyline only by time-out.
/// Ref: docs/methods.md, "Zero-clamped C2 splines", Repair.
/// @return kCollision (pair, time, depth), kLimits (joint, value, limit) or the stop's error.
Result<motion::CellMotion> make_curve(const CurveContext& context, const motion::JointPath& path,
                                      bool repair);

}  // namespace tandem::pipeline
