#pragma once
/// Shortening a path by shortcuts and cut corners, on proven edges.

#include "tandem/planning/planner.h"

namespace tandem::planning {

struct SimplifierOptions {
  int rounds = 4;  ///< Most rounds of corners and shortcuts, >= 1.
  /// Ends when a round shortens the path by less than this fraction, >= 0.
  double tolerance = 0.03;
  int shortcuts = 2;  ///< Between random places, tried in a round, >= 0.
};

/// First waypoints that are not needed are dropped. Then in each round corners are cut, half as
/// much where that fails, and points anywhere on the path are joined by straight edges. Parts of
/// edges are asked about only where Validity::holds_in_part() is false: else what is returned may
/// hold parts of accepted edges. Ref: Geraerts, Overmars, Creating high-quality paths for motion
/// planning (2007).
std::unique_ptr<PathSimplifier> make_simplifier(const SimplifierOptions& options = {});

}  // namespace tandem::planning
