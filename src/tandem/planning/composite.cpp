#include "tandem/planning/composite.h"

#include <algorithm>
#include <optional>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/planning/arm_validity.h"
#include "tandem/planning/measured_path.h"
#include "tandem/planning/simplifier.h"

namespace tandem::planning {

using Eigen::Index, Eigen::VectorXd;
using motion::JointPath;

namespace {

/// The paths of all arms, and motions along them: places are one fraction per arm.
class Coordination final : public Validity {
 public:
  Coordination(ArmQuestions& questions, std::vector<MeasuredPath> paths, Index dof)
      : questions_(questions), paths_(std::move(paths)), dof_(dof) {}

  Index arms() const { return static_cast<Index>(paths_.size()); }
  VectorXd configuration(const VectorXd& places) const {
    VectorXd q(dof_);
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const ArmQuestions::Arm& arm = questions_.arms[i];
      q.segment(arm.offset, arm.dof) = paths_[i].position(places[static_cast<Index>(i)]);
    }
    return q;
  }

  /// Appends the configurations after `a` on the straight way to `b`: those with an arm at a
  /// waypoint, and `b`.
  void append(const VectorXd& a, const VectorXd& b, JointPath& path) const {
    std::vector<double> parts{1.0};
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      paths_[i].append_waypoints(a[static_cast<Index>(i)], b[static_cast<Index>(i)], parts);
    }
    std::ranges::sort(parts);
    for (double part : parts) path.push_back(configuration(a + part * (b - a)));
  }

  bool state(const VectorXd& places) override {
    return questions_.between->state(configuration(places));
  }
  /// Only what takes two arms: alone each of them is valid on its path.
  bool edge(const VectorXd& a, const VectorXd& b) override {
    JointPath path{configuration(a)};
    append(a, b, path);
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!questions_.between->edge(path[i - 1], path[i])) return false;
    }
    return true;
  }
  const ValidityStats& stats() const override { return questions_.between->stats(); }

 private:
  ArmQuestions& questions_;
  std::vector<MeasuredPath> paths_;
  Index dof_;
};

class CompositePlanner final : public PathPlanner {
 public:
  explicit CompositePlanner(const CompositeOptions& options)
      : options_(options), everything_(make_rrt_connect(options.search)) {
    expects(options.tries >= 0 && options.first_samples > 0 && options.again_samples > 0 &&
                options.arm_samples > 0 && options.coordination_samples > 0,
            "tries are not negative, samples positive");
    RrtConnectOptions search = options.search;
    search.most_samples = options.first_samples;
    first_ = make_rrt_connect(search);
    search.most_samples = options.again_samples;
    again_ = make_rrt_connect(search);
    search.most_samples = options.arm_samples;
    search.local_radius = options.arm_local_radius;
    arm_ = make_rrt_connect(search);
    search.most_samples = options.coordination_samples;
    search.range = 0.2;  // Of paths of length 1.
    search.local_fraction = 0;
    coordination_ = make_rrt_connect(search);
  }

  Result<JointPath> plan(const PathProblem& problem, Validity& validity, std::uint64_t seed,
                         const StopCondition& stop) const override {
    if (!validity.splits_by_arm()) return everything_->plan(problem, validity, seed, stop);
    auto first = first_->plan(problem, validity, seed, stop);
    if (first || first.error().code != ErrorCode::kNoPath) return first;
    Rng rng(seed);
    ArmQuestions& questions = *validity.by_arm();
    bool may_differ = true;
    for (int k = 0; k < options_.tries && may_differ && !stop(); ++k) {
      if (const auto paths = arm_paths(problem, questions, rng, stop)) {
        if (const auto path = coordinated(problem, validity, questions, *paths, rng, stop)) {
          return *path;
        }
        // Straight edges are what every seed finds first.
        may_differ =
            std::ranges::any_of(*paths, [](const JointPath& path) { return path.size() > 2; });
      }
      first = again_->plan(problem, validity, rng.split(), stop);
      if (first || first.error().code != ErrorCode::kNoPath) return first;
    }
    return everything_->plan(problem, validity, rng.split(), stop);
  }

 private:
  /// One path per arm, as if it were alone; nothing if an arm finds none.
  std::optional<std::vector<JointPath>> arm_paths(const PathProblem& problem,
                                                  ArmQuestions& questions, Rng& rng,
                                                  const StopCondition& stop) const {
    std::vector<JointPath> paths;
    for (const ArmQuestions::Arm& arm : questions.arms) {
      const auto part = [&](const VectorXd& q) { return VectorXd(q.segment(arm.offset, arm.dof)); };
      const PathProblem own{part(problem.start), part(problem.goal), part(problem.lower),
                            part(problem.upper)};
      ArmValidity alone(arm, problem.start);
      auto path = arm_->plan(own, alone, rng.split(), stop);
      if (!path) return std::nullopt;
      paths.push_back(simplifier_->simplify(own, std::move(*path), alone, rng.split(), stop));
    }
    return paths;
  }

  /// A path of all arms along theirs; nothing if they are in each other's way.
  std::optional<JointPath> coordinated(const PathProblem& problem, Validity& validity,
                                       ArmQuestions& questions,
                                       const std::vector<JointPath>& arm_paths, Rng& rng,
                                       const StopCondition& stop) const {
    std::vector<MeasuredPath> paths(arm_paths.begin(), arm_paths.end());
    Coordination coordination(questions, std::move(paths), problem.start.size());
    const auto way = coordinate(coordination, rng, stop);
    if (!way) return std::nullopt;
    JointPath path{problem.start};
    for (std::size_t i = 1; i < way->size(); ++i) {
      coordination.append((*way)[i - 1], (*way)[i], path);
    }
    path.back() = problem.goal;
    path = without_duplicates(path);
    if (validity.holds_in_part()) return path;
    // Edges were judged in parts and as parts of longer ones.
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!validity.edge(path[i - 1], path[i])) return std::nullopt;
    }
    return path;
  }

  /// Places from all arms at their starts to all at their goals.
  std::optional<JointPath> coordinate(Coordination& coordination, Rng& rng,
                                      const StopCondition& stop) const {
    const Index arms = coordination.arms();
    const VectorXd zero = VectorXd::Zero(arms), one = VectorXd::Ones(arms);
    if (coordination.edge(zero, one)) return JointPath{zero, one};
    for (const std::vector<int>& order : orders(static_cast<int>(arms))) {
      JointPath way{zero};
      bool valid = true;
      for (std::size_t k = 0; k < order.size() && valid; ++k) {
        VectorXd next = way.back();
        next[order[k]] = 1;
        valid = coordination.edge(way.back(), next);
        way.push_back(std::move(next));
      }
      if (valid) return way;
    }
    const auto found = coordination_->plan({zero, one, zero, one}, coordination, rng.split(), stop);
    if (!found) return std::nullopt;
    return *found;
  }

  CompositeOptions options_;
  std::unique_ptr<PathPlanner> everything_, first_, again_, arm_, coordination_;
  std::unique_ptr<PathSimplifier> simplifier_ = make_simplifier();
};

}  // namespace

std::unique_ptr<PathPlanner> make_composite_planner(const CompositeOptions& options) {
  return std::make_unique<CompositePlanner>(options);
}

}  // namespace tandem::planning
