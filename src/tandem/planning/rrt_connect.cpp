#include "tandem/planning/rrt_connect.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/planning/nearest.h"

namespace tandem::planning {

using Eigen::Index, Eigen::VectorXd;
using motion::JointPath;

namespace {

/// Nodes with their parents; node 0 is the root.
class Tree {
 public:
  explicit Tree(Index dof) : dof_(dof), near_(static_cast<int>(dof)) {
    constexpr std::size_t kUsualSize = 64;  // Most trees grow without allocating.
    nodes_.reserve(kUsualSize * static_cast<std::size_t>(dof));
    near_.reserve(kUsualSize);
    parents_.reserve(kUsualSize);
    reach_squared_.reserve(kUsualSize);
  }

  int size() const { return static_cast<int>(parents_.size()); }
  Eigen::Map<const VectorXd> node(int i) const { return {nodes_.data() + i * dof_, dof_}; }

  int add(const VectorXd& q, int parent) {
    nodes_.insert(nodes_.end(), q.begin(), q.end());
    near_.add(q);
    parents_.push_back(parent);
    reach_squared_.push_back(std::numeric_limits<double>::infinity());
    return size() - 1;
  }

  /// The node nearest to q and the squared distance.
  std::pair<int, double> nearest(const VectorXd& q) const {
    const int best = near_.nearest(q);
    return {best, (node(best) - q).squaredNorm()};
  }

  /// How near a sample must be for node i to be extended towards it, squared.
  double reach_squared(int i) const { return reach_squared_[static_cast<std::size_t>(i)]; }
  void shrink(int i, double reach_squared) {
    reach_squared_[static_cast<std::size_t>(i)] = reach_squared;
  }

  /// Nodes from i to the root.
  JointPath branch(int i) const {
    JointPath path;
    for (; i >= 0; i = parents_[static_cast<std::size_t>(i)]) path.push_back(node(i));
    return path;
  }

 private:
  Index dof_;
  std::vector<double> nodes_;
  NearestConfigurations near_;
  std::vector<int> parents_;
  std::vector<double> reach_squared_;
};

/// Asks a stop condition now and then: its clock costs as much as a part of a sample.
class PatientStop {
 public:
  explicit PatientStop(const StopCondition& stop) : stop_(stop) {}
  /// As late as the last few questions took together, at most a tenth of a millisecond.
  bool operator()() {
    if (stop_.cancelled()) return true;
    if (--left_ > 0) return false;
    const auto now = Clock::now();
    const bool quick = now - last_ < std::chrono::microseconds(100);
    last_ = now;
    stride_ = quick ? std::min(2 * stride_, kLongestStride) : 1;
    left_ = stride_;
    return stop_();
  }

 private:
  static constexpr int kLongestStride = 16;
  const StopCondition& stop_;
  Clock::time_point last_{};
  int stride_ = 1, left_ = 0;
};

/// One search.
class Search {
 public:
  Search(const RrtConnectOptions& options, const PathProblem& problem, Validity& validity,
         std::uint64_t seed)
      : options_(options),
        problem_(problem),
        box_(search_box(problem)),
        validity_(validity),
        rng_(seed),
        trees_{Tree(problem.start.size()), Tree(problem.start.size())} {
    trees_[0].add(problem.start, -1);
    trees_[1].add(problem.goal, -1);
  }

  Result<JointPath> run(const StopCondition& stop);

 private:
  void sample(VectorXd& q);
  /// Adds one node towards q.   @return it, or -1.
  int extend(Tree& tree, const VectorXd& q);
  /// Steps from the nearest node towards q.   @return the node at q, or -1 if something is between.
  int connect(Tree& tree, const VectorXd& q);
  /// Adds the node one range on from `from` towards q, which is at `distance`; q itself if nearer.
  int step(Tree& tree, int from, const VectorXd& q, double distance);
  JointPath joined(int at_start, int at_goal) const;

  const RrtConnectOptions& options_;
  const PathProblem& problem_;
  const SearchBox box_;
  Validity& validity_;
  Rng rng_;
  Tree trees_[2];
  VectorXd from_, to_;
};

void Search::sample(VectorXd& q) {
  q.resize(problem_.start.size());
  if (options_.local_fraction > 0 && rng_.uniform() < options_.local_fraction) {
    q = problem_.start + rng_.uniform() * (problem_.goal - problem_.start);
    for (Index j = 0; j < q.size(); ++j) {
      q[j] += rng_.uniform(-options_.local_radius, options_.local_radius);
      q[j] = std::clamp(q[j], box_.lower[j], box_.upper[j]);
    }
    return;
  }
  for (Index j = 0; j < q.size(); ++j) q[j] = rng_.uniform(box_.lower[j], box_.upper[j]);
}

int Search::step(Tree& tree, int from, const VectorXd& q, double distance) {
  from_ = tree.node(from);
  if (distance <= options_.range) {
    to_ = q;
  } else {
    to_ = from_ + options_.range / distance * (q - from_);
  }
  return validity_.edge(from_, to_) ? tree.add(to_, from) : -1;
}

int Search::extend(Tree& tree, const VectorXd& q) {
  const auto [from, squared] = tree.nearest(q);
  if (squared > tree.reach_squared(from) || squared < kSameWaypoint * kSameWaypoint) return -1;
  const int node = step(tree, from, q, std::sqrt(squared));
  if (node < 0 && std::isfinite(options_.domain_radius)) {
    tree.shrink(from, std::pow(options_.domain_radius * options_.range, 2));
  }
  return node;
}

int Search::connect(Tree& tree, const VectorXd& q) {
  auto [at, squared] = tree.nearest(q);
  double distance = std::sqrt(squared);
  while (distance > 0) {
    const int next = step(tree, at, q, distance);
    if (next < 0) return -1;
    at = next;
    distance = (q - tree.node(at)).norm();
  }
  return at;
}

JointPath Search::joined(int at_start, int at_goal) const {
  JointPath path = trees_[0].branch(at_start);
  std::ranges::reverse(path);
  const JointPath rest = trees_[1].branch(at_goal);
  // Both end at the same configuration.
  path.insert(path.end(), rest.begin() + 1, rest.end());
  return path;
}

Result<JointPath> Search::run(const StopCondition& stop) {
  if (validity_.edge(problem_.start, problem_.goal)) {
    return JointPath{problem_.start, problem_.goal};
  }
  VectorXd q;
  PatientStop stopped(stop);
  int grown = 0;
  for (long samples = 0; samples < options_.most_samples; ++samples, grown = 1 - grown) {
    if (stopped()) return std::unexpected(stop.error("path planning"));
    if (options_.balanced) grown = trees_[0].size() <= trees_[1].size() ? 0 : 1;
    sample(q);
    const int node = extend(trees_[grown], q);
    if (node < 0) continue;
    q = trees_[grown].node(node);
    const int met = connect(trees_[1 - grown], q);
    if (met < 0) continue;
    return without_duplicates(grown == 0 ? joined(node, met) : joined(met, node));
  }
  return fail(ErrorCode::kNoPath, "path planning: none found with " +
                                      std::to_string(options_.most_samples) + " samples");
}

class RrtConnect final : public PathPlanner {
 public:
  explicit RrtConnect(const RrtConnectOptions& options) : options_(options) {
    expects(options.range > 0 && options.local_radius > 0 && options.domain_radius > 0 &&
                options.most_samples > 0,
            "range, radii and the number of samples are positive");
    expects(options.local_fraction >= 0 && options.local_fraction < 1,
            "some samples are drawn everywhere");
  }

  Result<JointPath> plan(const PathProblem& problem, Validity& validity, std::uint64_t seed,
                         const StopCondition& stop) const override {
    if (auto checked = check_problem(problem, validity); !checked) {
      return std::unexpected(checked.error());
    }
    if (stop()) return std::unexpected(stop.error("path planning"));
    return Search(options_, problem, validity, seed).run(stop);
  }

 private:
  RrtConnectOptions options_;
};

}  // namespace

std::unique_ptr<PathPlanner> make_rrt_connect(const RrtConnectOptions& options) {
  return std::make_unique<RrtConnect>(options);
}

}  // namespace tandem::planning
