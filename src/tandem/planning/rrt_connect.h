#pragma once
/// RRT-Connect on proven edges.

#include "tandem/planning/planner.h"

namespace tandem::planning {

struct RrtConnectOptions {
  double range = 1.0;  ///< Longest tree edge [rad or m], Euclidean over all joints, > 0.
  /// The smaller tree grows. Unbalanced, a tree in the open outgrows one in a corner.
  bool balanced = true;
  /// Part of the samples drawn near the straight line from start to goal, in [0, 1): at most
  /// `local_radius` beside it, per joint [rad or m], > 0. The rest are uniform, so that the search
  /// stays probabilistically complete.
  double local_fraction = 0.7;
  double local_radius = 1.0;
  /// Nodes that failed to extend are only extended towards samples nearer than this many ranges,
  /// > 0; infinity: all are. Ref: Yershova et al., Dynamic-Domain RRTs (2005).
  double domain_radius = std::numeric_limits<double>::infinity();
  /// Gives up (kNoPath) after so many samples, > 0; by default it searches until it is stopped.
  long most_samples = std::numeric_limits<long>::max();
};

/// Grows a tree from either end; a new node of one is connected to by the other, step by step. The
/// straight edge from start to goal is tried first.
/// Ref: Kuffner, LaValle, RRT-Connect (2000).
std::unique_ptr<PathPlanner> make_rrt_connect(const RrtConnectOptions& options = {});

}  // namespace tandem::planning
