#pragma once
/// Many plans of one cell: what they share is compiled once.

#include <memory>

#include "tandem/collision/compiled_cell.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// The questions of plan.h about one cell and the scenes that its queries make of it. Each cell is
/// compiled when first asked about, and the last few are kept. Thread-safe.
class Planner {
 public:
  explicit Planner(std::shared_ptr<const world::Workcell> cell);
  ~Planner();
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  const std::shared_ptr<const world::Workcell>& cell() const;

  Result<ResolvedQuery> resolve(const world::Query& query, std::uint64_t seed = 1,
                                const StopCondition& stop = {}) const;
  Result<std::vector<ResolvedQuery>> resolve_all(const std::vector<world::Query>& queries,
                                                 std::uint64_t seed = 1,
                                                 const StopCondition& stop = {}) const;
  Result<void> check_ends(const ResolvedQuery& query) const;
  Result<Plan> plan(const world::Query& query, const PlanOptions& options = {},
                    PlanReport* report = nullptr) const;
  Result<Plan> plan(const ResolvedQuery& query, const PlanOptions& options = {},
                    PlanReport* report = nullptr) const;
  Result<PathPlan> plan_path(const ResolvedQuery& query, const PlanOptions& options = {},
                             PlanReport* report = nullptr) const;
  /// In cell().
  Result<double> certify_path(const motion::JointPath& path,
                              const std::stop_token& token = {}) const;

  /// A cell, such as the one that a query is planned in; null stands for cell().
  std::shared_ptr<const collision::CompiledCell> compiled(
      const std::shared_ptr<const world::Workcell>& cell = {}) const;
  /// Compiles all that plans in this cell by these options will ask for.
  void prepare(const std::shared_ptr<const world::Workcell>& cell,
               const PlanOptions& options) const;

 private:
  class Cells;
  std::unique_ptr<Cells> cells_;
};

}  // namespace tandem::pipeline
