#pragma once
/// Planning for several arms by planning each alone and coordinating their paths.

#include "tandem/planning/rrt_connect.h"

namespace tandem::planning {

struct CompositeOptions {
  RrtConnectOptions search = {};  ///< Of every search: one arm, coordination, all arms at once.
  /// Samples of the first search with all arms at once: what is easy needs no splitting.
  long first_samples = 30;
  long again_samples = 200;  ///< The same after each try, with new seeds.
  int tries = 20;            ///< Sets of paths, one per arm, that are coordinated, >= 0.
  long arm_samples = 5000;   ///< Most samples per arm and try, > 0.
  /// Instead of search.local_radius for an arm alone: paths of one try differ from those of others.
  double arm_local_radius = 2.0;
  long coordination_samples = 100;
};

/// Where validity.splits_by_arm(): first a short search with all arms at once, then a path per arm
/// against the world and itself, and, cheapest first, all arms at once, one after the other in some
/// order, and a search in the space of the places on their paths. If no try succeeds, or the
/// question does not split, RRT-Connect in the full space, which searches until it is stopped: so
/// the planner stays probabilistically complete. Ref: docs/methods.md, "Composite planning".
std::unique_ptr<PathPlanner> make_composite_planner(const CompositeOptions& options = {});

}  // namespace tandem::planning
