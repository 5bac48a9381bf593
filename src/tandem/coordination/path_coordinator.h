#pragma once
/// Coordination by a path planner in coordination space: the paper's.

#include <memory>

#include "tandem/coordination/coordinator.h"
#include "tandem/planning/planner.h"

namespace tandem::coordination {

struct PathCoordinatorOptions {
  /// Longest unchecked piece of an edge (L1), as a fraction of the space's extent, which is the sum
  /// of the durations, > 0. Ref: the paper, "Planner Parameters".
  double segment_fraction = 0.001;
};

/// Plans from all starts to all ends in coordination space, both directions of time allowed, and
/// simplifies. Edges are sampled and not proven: what touches between samples goes unseen.
///
/// The paper does not say when a waypoint is reached. Here it is as soon as no arm runs faster than
/// planned, by the L-infinity distance (make_schedule), so that one arm always runs as planned.
/// A planner that searches until it stops reports a deadlock as a time-out.
/// Ref: the paper, "Decoupled Planning with Fixed-Path Coordination".
std::unique_ptr<Coordinator> make_path_coordinator(
    std::shared_ptr<const planning::PathPlanner> planner,
    std::shared_ptr<const planning::PathSimplifier> simplifier,
    const PathCoordinatorOptions& options = {});

}  // namespace tandem::coordination
