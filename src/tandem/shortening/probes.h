#pragma once
/// Where a path's distances are looked at, and what they must be. Private to shortening/.

#include <cstdint>
#include <utility>

#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// A configuration of the path: `at` between waypoint `edge` (0) and the next (1).
struct Probe {
  int edge;
  double at;
  double required = 0;  ///< [m] of every pair.
  /// Pairs of shapes that pushed here the last time, and how much.
  std::vector<std::pair<std::uint64_t, double>> pushing = {};
};

/// Every inner waypoint, and points evenly spread inside each edge.
/// @param per_edge  points inside each edge.
std::vector<Probe> make_probes(const motion::JointPath& path, const std::vector<int>& per_edge);

/// The probes' configurations, a column each.
void place_probes(const motion::JointPath& path, const std::vector<Probe>& probes,
                  Eigen::MatrixXd& Q);

/// Fills what must be kept: `clearance`, or what `reference` has there if that is less.
void require(const collision::BatchChecker& checker, const collision::BatchPairs& pairs,
             const motion::JointPath& reference, double clearance,
             collision::BatchChecker::Scratch& scratch, std::vector<Probe>& probes);

}  // namespace tandem::shortening
