#pragma once
/// Shortening a path by shortcuts and cut corners, on proven edges.

#include "tandem/planning/planner.h"

namespace tandem::planning {

struct SimplifierOptions {
  int rounds = 8;  ///< Most rounds of shortcuts and corners, >= 1.
  /// Ends when a round shortens the path by less than this fraction, >= 0.
  double tolerance = 0.01;
  int shortcuts_per_waypoint = 2;  ///< Tried in a round, >= 0.
};

/// Each round: waypoints that are not needed are dropped, points anywhere on the path are joined by
/// straight edges, and corners are cut, half as much where that fails.
/// Ref: Geraerts, Overmars, Creating high-quality paths for motion planning (2007).
std::unique_ptr<PathSimplifier> make_simplifier(const SimplifierOptions& options = {});

}  // namespace tandem::planning
