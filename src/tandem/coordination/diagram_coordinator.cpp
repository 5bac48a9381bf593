#include "tandem/coordination/diagram_coordinator.h"

#include <algorithm>
#include <deque>
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
    auto some = alternatives(problem, 1, seed, stop);
    if (!some) return std::unexpected(some.error());
    return std::move(some->front());
  }

  Result<std::vector<Schedule>> alternatives(const CoordinationProblem& problem, int most,
                                             std::uint64_t /*seed*/,
                                             const StopCondition& stop) const override {
    expects(most > 0, "at least one schedule is asked for");
    const auto scratch = problem.checker.make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) {
      return std::unexpected(ends.error());
    }
    if (stop()) return std::unexpected(stop.error("coordinating"));
    if (problem.arms.size() == 1) {
      return std::vector{schedule_of(Track(problem, 0))};
    }
    return problem.arms.size() == 2 ? of_two(problem, most, stop) : of_many(problem, most, stop);
  }

 private:
  Result<std::vector<Schedule>> of_two(const CoordinationProblem& problem, int most,
                                       const StopCondition& stop) const {
    const Track x(problem, 0), y(problem, 1);
    CoordinationDiagram diagram(problem, x, y, options_.diagram);
    const auto ways = find_ways(diagram, options_.search, most, stop);
    if (ways.empty()) return std::unexpected(explain(diagram, stop));
    std::vector<Schedule> schedules;
    for (const DiagramWay& way : ways) schedules.push_back(schedule_of(merge(diagram, way.points)));
    return schedules;
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

  /// All arms in this order; nothing if one cannot be merged.
  std::optional<Schedule> merge_all(const CoordinationProblem& problem,
                                    const std::vector<int>& order,
                                    const StopCondition& stop) const {
    std::deque<Track> tracks;  // Keeps references valid.
    const Track* merged = &tracks.emplace_back(problem, order[0]);
    for (std::size_t k = 1; k < order.size(); ++k) {
      const Track& next = tracks.emplace_back(problem, order[k]);
      CoordinationDiagram diagram(problem, *merged, next, options_.diagram);
      const auto found = find_way(diagram, options_.search, {}, stop);
      if (!found.way) return std::nullopt;
      merged = &tracks.emplace_back(merge(diagram, found.way->points));
    }
    return schedule_of(*merged);
  }

  Result<std::vector<Schedule>> of_many(const CoordinationProblem& problem, int most,
                                        const StopCondition& stop) const {
    const double least = durations(problem).maxCoeff();
    std::vector<Schedule> schedules;
    for (const auto& order : orders(static_cast<int>(problem.arms.size()))) {
      if (stop()) break;
      auto schedule = merge_all(problem, order, stop);
      if (!schedule) continue;
      const bool is_best = schedule->makespan() * (1 - options_.search.gap) <= least;
      schedules.push_back(std::move(*schedule));
      if (is_best && most == 1) break;
    }
    if (!schedules.empty()) {
      std::ranges::stable_sort(schedules, {}, &Schedule::makespan);
      schedules.resize(std::min(schedules.size(), static_cast<std::size_t>(most)));
      return schedules;
    }
    if (stop()) return std::unexpected(stop.error("coordinating"));
    return search_all(problem, stop);
  }

  /// What no order of merging coordinates.
  Result<std::vector<Schedule>> search_all(const CoordinationProblem& problem,
                                           const StopCondition& stop) const {
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
    auto schedule = search_jointly(problem, {options_.search, options_.diagram}, stop);
    if (!schedule) return std::unexpected(schedule.error());
    return std::vector{std::move(*schedule)};
  }

  DiagramCoordinatorOptions options_;
};

}  // namespace

std::unique_ptr<Coordinator> make_diagram_coordinator(const DiagramCoordinatorOptions& options) {
  return std::make_unique<DiagramCoordinator>(options);
}

}  // namespace tandem::coordination
