#pragma once
/// Where a path's distances are looked at, and what they must be. Private to shortening/.

#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// A configuration of the path: `at` between waypoint `edge` (0) and the next (1).
struct Probe {
  int edge;
  double at;
  double required;  ///< [m] of every pair.
};

/// Pairs near at a probe.
using NearPairs = std::vector<collision::PairClearance>;

Eigen::VectorXd probe_position(const motion::JointPath& path, const Probe& probe);

/// Every inner waypoint, and points evenly spread inside each edge.
/// What must be kept is `clearance`, or what `reference` has there if that is less.
/// @param per_edge  points inside each edge; empty: one each.
std::vector<Probe> make_probes(const collision::SsvChecker& checker,
                               const world::PairSelection& selection,
                               const motion::JointPath& reference, const std::vector<int>& per_edge,
                               double clearance, collision::CollisionChecker::Scratch& scratch);

}  // namespace tandem::shortening
