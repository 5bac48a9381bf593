#include "tandem/shortening/probes.h"

#include "tandem/core/contract.h"

namespace tandem::shortening {

std::vector<Probe> make_probes(const motion::JointPath& path, const std::vector<int>& per_edge) {
  expects(per_edge.size() + 1 == path.size(), "one number of points per edge");
  std::vector<Probe> probes;
  for (std::size_t e = 0; e < per_edge.size(); ++e) {
    const int edge = static_cast<int>(e);
    if (e > 0) probes.push_back({edge, 0.0});
    for (int k = 1; k <= per_edge[e]; ++k) probes.push_back({edge, k / (per_edge[e] + 1.0)});
  }
  return probes;
}

void place_probes(const motion::JointPath& path, const std::vector<Probe>& probes,
                  Eigen::MatrixXd& Q) {
  Q.resize(path.front().size(), static_cast<Eigen::Index>(probes.size()));
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const auto edge = static_cast<std::size_t>(probes[k].edge);
    const double at = probes[k].at;
    auto column = Q.col(static_cast<Eigen::Index>(k));
    column = path[edge];
    if (at > 0) column += at * (path[edge + 1] - path[edge]);
  }
}

void require(const collision::BatchChecker& checker, const collision::BatchPairs& pairs,
             const motion::JointPath& reference, double clearance,
             collision::BatchChecker::Scratch& scratch, std::vector<Probe>& probes) {
  Eigen::MatrixXd Q;
  place_probes(reference, probes, Q);
  Eigen::VectorXd least(Q.cols());
  checker.least_clearances(Q, pairs, clearance, scratch, least);
  for (std::size_t k = 0; k < probes.size(); ++k) {
    probes[k].required = least[static_cast<Eigen::Index>(k)];
  }
}

}  // namespace tandem::shortening
