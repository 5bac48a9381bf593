#include "tandem/coordination/path_coordinator.h"

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

namespace {

class PathCoordinator final : public Coordinator {
 public:
  PathCoordinator(std::shared_ptr<const planning::PathPlanner> planner,
                  std::shared_ptr<const planning::PathSimplifier> simplifier,
                  const PathCoordinatorOptions& options)
      : planner_(std::move(planner)), simplifier_(std::move(simplifier)), options_(options) {
    expects(planner_ && simplifier_, "a path coordinator needs a planner and a simplifier");
    expects(options_.segment_fraction > 0, "the longest unchecked piece is positive");
  }

  Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t seed,
                              const StopCondition& stop) const override {
    const auto scratch = problem.exact().make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) {
      return std::unexpected(ends.error());
    }
    if (stop()) return std::unexpected(stop.error("coordinating the arms' motions"));
    const VectorXd T = durations(problem);
    const world::PairSelection pairs = pairs_between_arms(problem.cell());
    VectorXd q(problem.cell().dof());
    const auto validity = planning::make_sampled_validity(
        [&](const VectorXd& place) {
          Index first = 0;
          for (Index i = 0; i < place.size(); ++i) {
            const motion::PiecewiseCubic& arm = problem.arms[static_cast<std::size_t>(i)];
            arm.position(place[i], q.segment(first, arm.dof()));
            first += arm.dof();
          }
          return problem.exact().is_free(q, pairs, *scratch);
        },
        options_.segment_fraction * T.sum());
    const planning::PathProblem space{VectorXd::Zero(T.size()), T, VectorXd::Zero(T.size()), T};
    Rng seeds(seed);
    const std::uint64_t planner_seed = seeds.split(), simplifier_seed = seeds.split();
    auto path = planner_->plan(space, *validity, planner_seed, stop);
    if (!path) return std::unexpected(coordination_error(path.error()));
    const auto shorter =
        simplifier_->simplify(space, std::move(*path), *validity, simplifier_seed, stop);
    if (stop.cancelled()) return std::unexpected(stop.error("coordinating the arms' motions"));
    return make_schedule(shorter);
  }

 private:
  static Error coordination_error(const Error& error) {
    if (error.code == ErrorCode::kNoPath) {
      return {ErrorCode::kCoordination, "in coordination space: " + error.message};
    }
    return {error.code, "coordinating the arms' motions: " + error.message};
  }

  std::shared_ptr<const planning::PathPlanner> planner_;
  std::shared_ptr<const planning::PathSimplifier> simplifier_;
  PathCoordinatorOptions options_;
};

}  // namespace

std::unique_ptr<Coordinator> make_path_coordinator(
    std::shared_ptr<const planning::PathPlanner> planner,
    std::shared_ptr<const planning::PathSimplifier> simplifier,
    const PathCoordinatorOptions& options) {
  return std::make_unique<PathCoordinator>(std::move(planner), std::move(simplifier), options);
}

}  // namespace tandem::coordination
