#include "tandem/coordination/diagram_coordinator.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <numeric>

#include "tandem/coordination/deadlock.h"
#include "tandem/coordination/joint_search.h"
#include "tandem/coordination/merge.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

namespace {

/// Orders in which arms are merged; the first two of them are alike.
std::vector<std::vector<int>> orders(int arms) {
  std::vector<int> order(static_cast<std::size_t>(arms));
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<int>> all;
  if (arms <= 4) {
    do {
      if (order[0] < order[1]) all.push_back(order);
    } while (std::ranges::next_permutation(order).found);
    return all;
  }
  for (int k = 0; k < arms; ++k) {
    all.push_back(order);
    std::ranges::rotate(order, order.begin() + 1);
  }
  return all;
}

class DiagramCoordinator final : public Coordinator {
 public:
  explicit DiagramCoordinator(const DiagramCoordinatorOptions& options) : options_(options) {}

  Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t seed,
                              const StopCondition& stop) const override {
    auto one = alternatives(problem, 1, seed, stop);
    if (!one) return std::unexpected(one.error());
    return std::move(one->front());
  }

  Result<void> explore(const CoordinationProblem& problem, std::uint64_t /*seed*/,
                       const StopCondition& stop, const Use& use) const override {
    const auto scratch = problem.compiled.batch().make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) return ends;
    if (stop()) return std::unexpected(stop.error("coordinating"));
    if (problem.arms.size() == 1) {
      use(schedule_of(Track(problem, 0)));
      return {};
    }
    return problem.arms.size() == 2 ? of_two(problem, stop, use) : of_many(problem, stop, use);
  }

 private:
  Result<void> of_two(const CoordinationProblem& problem, const StopCondition& stop,
                      const Use& use) const {
    const Track x(problem, 0), y(problem, 1);
    CoordinationDiagram diagram(problem, x, y, options_.diagram);
    const auto use_way = [&](const DiagramWay& way) {
      return use(schedule_of(merge(diagram, way.points)));
    };
    if (!explore_ways(diagram, options_.search, stop, use_way)) {
      return std::unexpected(explain(diagram, stop));
    }
    return {};
  }

  /// Why the search in a diagram of two arms found nothing.
  Error explain(const CoordinationDiagram& diagram, const StopCondition& stop) const {
    const auto deadlock = find_deadlock(diagram);
    if (deadlock) return {ErrorCode::kCoordination, describe(diagram, *deadlock)};
    if (stop()) return stop.error("coordinating");
    const auto open = std::ranges::find_if(diagram.cells(), [](const auto& c) {
      return c.is_leaf() && (c.state == CellState::kBlocked || c.state == CellState::kOpen);
    });
    Eigen::VectorXd place(2);
    place << diagram.at_x(open->x0), diagram.at_y(open->y0);
    return {ErrorCode::kCoordination,
            std::string(options_.search.monotone ? "no timing without going back" : "no timing") +
                " was found that brings both arms to their goals, and no proof that there is none; "
                "first in the way are " +
                describe_blocking(diagram.cell(), open->pair, place)};
  }

  /// All arms in this order; nothing if one cannot be merged, or if it takes `longest` [s].
  std::optional<Schedule> merge_all(const CoordinationProblem& problem,
                                    const std::vector<int>& order, double longest,
                                    const StopCondition& stop) const {
    std::deque<Track> tracks;  // Keeps references valid.
    const Track* merged = &tracks.emplace_back(problem, order[0]);
    for (std::size_t k = 1; k < order.size(); ++k) {
      const Track& next = tracks.emplace_back(problem, order[k]);
      CoordinationDiagram diagram(problem, *merged, next, options_.diagram);
      const auto found = find_way(diagram, options_.search, {}, stop);
      if (!found.way || found.way->length >= longest) return std::nullopt;
      merged = &tracks.emplace_back(merge(diagram, found.way->points));
    }
    return schedule_of(*merged);
  }

  Result<void> of_many(const CoordinationProblem& problem, const StopCondition& stop,
                       const Use& use) const {
    const double least = durations(problem).maxCoeff() / (1 - options_.search.gap);
    std::vector<Schedule> schedules;
    double longest = std::numeric_limits<double>::infinity();
    for (const auto& order : orders(static_cast<int>(problem.arms.size()))) {
      if (stop()) break;
      auto schedule = merge_all(problem, order, longest, stop);
      if (!schedule) continue;
      schedules.push_back(std::move(*schedule));
      // Those that take much longer are of no use.
      longest = std::min(longest, schedules.back().makespan() * (1 + options_.search.gap));
      if (schedules.back().makespan() <= least) break;
    }
    if (schedules.empty()) {
      if (stop()) return std::unexpected(stop.error("coordinating"));
      return search_all(problem, stop, use);
    }
    std::ranges::stable_sort(schedules, {}, &Schedule::makespan);
    longest = std::numeric_limits<double>::infinity();
    for (const Schedule& schedule : schedules) {
      if (schedule.makespan() >= longest || stop()) break;
      longest = std::min(longest, use(schedule));
    }
    return {};
  }

  /// What no order of merging coordinates.
  Result<void> search_all(const CoordinationProblem& problem, const StopCondition& stop,
                          const Use& use) const {
    const int arms = static_cast<int>(problem.arms.size());
    for (int i = 0; i < arms; ++i) {
      for (int j = i + 1; j < arms; ++j) {
        const Track x(problem, i), y(problem, j);
        CoordinationDiagram diagram(problem, x, y, options_.diagram);
        if (find_way(diagram, options_.search, {}, stop).way) continue;
        const auto deadlock = find_deadlock(diagram);
        if (deadlock) return fail(ErrorCode::kCoordination, describe(diagram, *deadlock));
      }
    }
    const auto schedule = search_jointly(problem, {options_.search, options_.diagram}, stop);
    if (!schedule) return std::unexpected(schedule.error());
    use(*schedule);
    return {};
  }

  DiagramCoordinatorOptions options_;
};

}  // namespace

void prepare_coordination(const collision::CompiledCell& compiled) {
  const std::size_t arms = compiled.cell().arms().size();
  if (arms < 2 || arms > 4) return;
  compiled.pairs(world::PairScope::several());
  for (std::size_t arm = 0; arm < arms; ++arm) {
    const world::ArmMask one = world::ArmMask{1} << arm;
    for (world::ArmMask others = 1; others < world::ArmMask{1} << arms; ++others) {
      if ((others & one) == 0) compiled_pairs(compiled, one, others);
    }
  }
}

std::unique_ptr<Coordinator> make_diagram_coordinator(const DiagramCoordinatorOptions& options) {
  return std::make_unique<DiagramCoordinator>(options);
}

}  // namespace tandem::coordination
