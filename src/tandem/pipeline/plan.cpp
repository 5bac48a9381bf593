#include "tandem/pipeline/plan.h"

#include "tandem/pipeline/path.h"
#include "tandem/pipeline/planner.h"

namespace tandem::pipeline {

const char* to_string(Strategy strategy) {
  switch (strategy) {
    case Strategy::kCentralized:
      return "centralized";
    case Strategy::kDecoupled:
      return "decoupled";
    case Strategy::kAuto:
      return "auto";
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
Result<void> check_end(const collision::CompiledCell& compiled, const Eigen::VectorXd& q,
                       collision::CollisionChecker::Scratch& scratch, const std::string& what) {
  const world::Workcell& cell = compiled.cell();
  if (auto inside = cell.check_position_limits(q); !inside) {
    return fail(inside.error().code, what + ": " + inside.error().message);
  }
  const world::PairSelection& selection = compiled.selection(world::PairScope::all());
  if (compiled.exact().is_free(q, selection, scratch)) return {};
  return fail(
      ErrorCode::kInfeasible,
      what + " is in collision: " +
          collision::describe(cell, compiled.exact().least_clearance(q, selection, scratch)) +
          "; move it away, or allow the pair in the workcell");
}

}  // namespace

Result<void> check_ends(const collision::CompiledCell& compiled, const ResolvedQuery& query) {
  const auto scratch = compiled.exact().make_scratch();
  auto start = check_end(compiled, query.start, *scratch, "start of query '" + query.name + "'");
  if (!start) return start;
  return check_end(compiled, query.goal, *scratch, "goal of query '" + query.name + "'");
}

Result<void> check_ends(const world::Workcell& cell, const ResolvedQuery& query) {
  // Shared only for the length of this call.
  const std::shared_ptr<const world::Workcell> borrowed(std::shared_ptr<void>(), &cell);
  return Planner(borrowed).check_ends(query);
}

Result<ResolvedQuery> resolve(const std::shared_ptr<const world::Workcell>& cell,
                              const world::Query& query, std::uint64_t seed,
                              const StopCondition& stop) {
  return Planner(cell).resolve(query, seed, stop);
}

Result<std::vector<ResolvedQuery>> resolve_all(const std::shared_ptr<const world::Workcell>& cell,
                                               const std::vector<world::Query>& queries,
                                               std::uint64_t seed, const StopCondition& stop) {
  return Planner(cell).resolve_all(queries, seed, stop);
}

Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const ResolvedQuery& ends,
                  const PlanOptions& options, PlanReport* report) {
  return Planner(cell).plan(ends, options, report);
}

Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const world::Query& query,
                  const PlanOptions& options, PlanReport* report) {
  return Planner(cell).plan(query, options, report);
}

Result<PathPlan> plan_path(const std::shared_ptr<const world::Workcell>& cell,
                           const ResolvedQuery& query, const PlanOptions& options,
                           PlanReport* report) {
  return Planner(cell).plan_path(query, options, report);
}

Result<double> certify_path(const std::shared_ptr<const world::Workcell>& cell,
                            const motion::JointPath& path, const std::stop_token& token) {
  return Planner(cell).certify_path(path, token);
}

}  // namespace tandem::pipeline
