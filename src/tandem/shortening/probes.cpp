#include "tandem/shortening/probes.h"

#include <algorithm>

#include "tandem/core/contract.h"

namespace tandem::shortening {

Eigen::VectorXd probe_position(const motion::JointPath& path, const Probe& probe) {
  const auto edge = static_cast<std::size_t>(probe.edge);
  if (probe.at == 0) return path[edge];
  return path[edge] + probe.at * (path[edge + 1] - path[edge]);
}

std::vector<Probe> make_probes(const collision::SsvChecker& checker,
                               const world::PairSelection& selection,
                               const motion::JointPath& reference, const std::vector<int>& per_edge,
                               double clearance, collision::CollisionChecker::Scratch& scratch) {
  const int edges = static_cast<int>(reference.size()) - 1;
  expects(per_edge.empty() || static_cast<int>(per_edge.size()) == edges,
          "one number of points per edge, or none");
  std::vector<Probe> probes;
  for (int e = 0; e < edges; ++e) {
    if (e > 0) probes.push_back({e, 0.0, clearance});
    const int inside = per_edge.empty() ? 1 : per_edge[static_cast<std::size_t>(e)];
    for (int k = 1; k <= inside; ++k) probes.push_back({e, k / (inside + 1.0), clearance});
  }
  NearPairs near;
  for (Probe& probe : probes) {
    checker.clearances(probe_position(reference, probe), selection, clearance, scratch, near);
    for (const collision::PairClearance& pair : near) {
      probe.required = std::min(probe.required, pair.distance);
    }
  }
  return probes;
}

}  // namespace tandem::shortening
