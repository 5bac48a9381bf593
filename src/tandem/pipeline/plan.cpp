#include "tandem/pipeline/plan.h"

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/contract.h"
#include "tandem/pipeline/centralized.h"
#include "tandem/pipeline/modules.h"
#include "tandem/pipeline/path.h"

namespace tandem::pipeline {

const char* to_string(Strategy strategy) {
  switch (strategy) {
    case Strategy::kCentralized:
      return "centralized";
  }
  return "unknown";
}

const char* to_string(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return "default";
    case Preset::kPaper:
      return "paper";
  }
  return "unknown";
}

namespace {

/// One end of a query at which the cell can stand.
Result<void> check_end(const collision::SsvChecker& checker, const Eigen::VectorXd& q,
                       const std::string& what) {
  const world::Workcell& cell = checker.cell();
  if (auto inside = cell.check_position_limits(q); !inside) {
    return fail(inside.error().code, what + ": " + inside.error().message);
  }
  const auto scratch = checker.make_scratch();
  const collision::PairClearance nearest =
      checker.least_clearance(q, cell.select(world::PairScope::all()), *scratch);
  if (nearest.pair >= 0 && nearest.distance <= 0) {
    return fail(ErrorCode::kInfeasible,
                what + " is in collision: " + collision::describe(cell, nearest) +
                    "; move it away, or allow the pair in the workcell");
  }
  return {};
}

}  // namespace

Result<void> check_ends(const collision::SsvChecker& checker, const ResolvedQuery& query) {
  auto start = check_end(checker, query.start, "start of query '" + query.name + "'");
  if (!start) return start;
  return check_end(checker, query.goal, "goal of query '" + query.name + "'");
}

Result<void> check_ends(const world::Workcell& cell, const ResolvedQuery& query) {
  // The checker shares the cell only for the length of this call.
  const std::shared_ptr<const world::Workcell> borrowed(std::shared_ptr<void>(), &cell);
  return check_ends(collision::SsvChecker(query.cell ? query.cell : borrowed), query);
}

Result<Plan> plan(const std::shared_ptr<const world::Workcell>& given, const ResolvedQuery& ends,
                  const PlanOptions& options, PlanReport* report) {
  ResolvedQuery query = ends;
  if (!query.cell) query.cell = given;
  const std::shared_ptr<const world::Workcell>& cell = query.cell;
  expects(cell != nullptr, "plan needs a workcell");
  expects(query.start.size() == cell->dof() && query.goal.size() == cell->dof(),
          "start and goal must have the cell's number of joints");
  expects(options.deadline > 0, "the deadline must be positive");
  PlanReport own;
  PlanReport& filled = report ? *report : own;
  filled = {};
  const StopCondition stop = StopCondition::after(options.deadline, options.token);

  auto planned = [&]() -> Result<Plan> {
    ModuleTimer timer(filled.times.total);
    const collision::SsvChecker checker(cell);
    if (auto feasible = check_ends(checker, query); !feasible) {
      return std::unexpected(feasible.error());
    }
    return plan_centralized(checker, query, options, stop, filled);
  }();
  if (planned) planned->report = filled;
  return planned;
}

Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const world::Query& query,
                  const PlanOptions& options, PlanReport* report) {
  auto resolved =
      resolve(cell, query, options.seed, StopCondition::after(options.deadline, options.token));
  if (!resolved) return std::unexpected(resolved.error());
  return plan(cell, *resolved, options, report);
}

}  // namespace tandem::pipeline
