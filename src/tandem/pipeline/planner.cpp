#include "tandem/pipeline/planner.h"

#include <algorithm>
#include <mutex>

#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/core/contract.h"
#include "tandem/pipeline/centralized.h"
#include "tandem/pipeline/decoupled.h"
#include "tandem/pipeline/modules.h"
#include "tandem/pipeline/path.h"
#include "tandem/pipeline/resolve.h"

namespace tandem::pipeline {

using collision::CompiledCell;
using world::Workcell;

/// The compiled cells that were asked for last.
class Planner::Cells {
 public:
  explicit Cells(std::shared_ptr<const Workcell> cell) : cell_(std::move(cell)) {}

  const std::shared_ptr<const Workcell>& cell() const { return cell_; }
  std::shared_ptr<const CompiledCell> compiled(const std::shared_ptr<const Workcell>& cell);

 private:
  static constexpr std::size_t kMost = 32;

  std::shared_ptr<const Workcell> cell_;
  std::mutex mutex_;
  std::vector<std::shared_ptr<const CompiledCell>> recent_;  // The last asked for at the end.
};

std::shared_ptr<const CompiledCell> Planner::Cells::compiled(
    const std::shared_ptr<const Workcell>& cell) {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(recent_, cell, &CompiledCell::shared_cell);
  if (known != recent_.end()) {
    std::rotate(known, known + 1, recent_.end());
    return recent_.back();
  }
  const CompiledCell* like = recent_.empty() ? nullptr : recent_.back().get();
  auto made = std::make_shared<const CompiledCell>(cell, like);
  if (recent_.size() == kMost) recent_.erase(recent_.begin());
  recent_.push_back(std::move(made));
  return recent_.back();
}

namespace {

const std::shared_ptr<const Workcell>& expect_cell(const std::shared_ptr<const Workcell>& cell) {
  expects(cell != nullptr, "a planner needs a workcell");
  return cell;
}

void expect_question(const Workcell& cell, const ResolvedQuery& query, const PlanOptions& options) {
  expects(query.start.size() == cell.dof() && query.goal.size() == cell.dof(),
          "start and goal must have the cell's number of joints");
  expects(options.deadline > 0, "the deadline must be positive");
}

Result<motion::CellMotion> plan_by_strategy(const CompiledCell& in, const ResolvedQuery& query,
                                            const PlanOptions& options, const StopCondition& stop,
                                            PlanReport& report) {
  switch (options.strategy) {
    case Strategy::kCentralized:
      break;
    case Strategy::kDecoupled:
      return plan_decoupled(in, query, options, stop, report);
    case Strategy::kAuto:
      return plan_auto(in, query, options, stop, report);
  }
  auto planned = plan_motion(in, query, options, stop, report);
  if (!planned) return std::unexpected(planned.error());
  return std::move(planned->curve);
}

}  // namespace

Planner::Planner(std::shared_ptr<const Workcell> cell)
    : cells_(std::make_unique<Cells>(expect_cell(cell))) {}

Planner::~Planner() = default;

const std::shared_ptr<const Workcell>& Planner::cell() const { return cells_->cell(); }

std::shared_ptr<const CompiledCell> Planner::compiled(
    const std::shared_ptr<const Workcell>& cell) const {
  return cells_->compiled(cell ? cell : cells_->cell());
}

void Planner::prepare(const std::shared_ptr<const Workcell>& cell,
                      const PlanOptions& options) const {
  const auto whole = compiled(cell);
  if (options.strategy != Strategy::kDecoupled) prepare_modules(options.preset, *whole);
  if (options.strategy == Strategy::kCentralized) return;
  for (std::size_t i = 0; i < whole->cell().arms().size(); ++i) {
    prepare_modules(options.preset, whole->alone(static_cast<int>(i)));
  }
  if (options.preset == Preset::kDefault) coordination::prepare_coordination(*whole);
}

Result<ResolvedQuery> Planner::resolve(const world::Query& query, std::uint64_t seed,
                                       const StopCondition& stop) const {
  return resolve_query(*this, query, seed, stop);
}

Result<std::vector<ResolvedQuery>> Planner::resolve_all(const std::vector<world::Query>& queries,
                                                        std::uint64_t seed,
                                                        const StopCondition& stop) const {
  return resolve_queries(*this, queries, seed, stop);
}

Result<void> Planner::check_ends(const ResolvedQuery& query) const {
  return pipeline::check_ends(*compiled(query.cell), query);
}

Result<Plan> Planner::plan(const ResolvedQuery& ends, const PlanOptions& options,
                           PlanReport* report) const {
  ResolvedQuery query = ends;
  if (!query.cell) query.cell = cell();
  expect_question(*query.cell, query, options);
  PlanReport own;
  PlanReport& filled = report ? *report : own;
  filled = {};
  const StopCondition stop = StopCondition::after(options.deadline, options.token);

  auto motion = [&]() -> Result<motion::CellMotion> {
    ModuleTimer timer(filled.times.total);
    const auto in = compiled(query.cell);
    if (auto feasible = pipeline::check_ends(*in, query); !feasible) {
      return std::unexpected(feasible.error());
    }
    return plan_by_strategy(*in, query, options, stop, filled);
  }();
  if (!motion) return std::unexpected(motion.error());
  return Plan{query.name, options.strategy,   options.preset, options.seed, options.plpp,
              query,      std::move(*motion), filled};
}

Result<Plan> Planner::plan(const world::Query& query, const PlanOptions& options,
                           PlanReport* report) const {
  auto resolved =
      resolve(query, options.seed, StopCondition::after(options.deadline, options.token));
  if (!resolved) return std::unexpected(resolved.error());
  return plan(*resolved, options, report);
}

Result<PathPlan> Planner::plan_path(const ResolvedQuery& query, const PlanOptions& options,
                                    PlanReport* report) const {
  const auto in = compiled(query.cell);
  expect_question(in->cell(), query, options);
  PlanReport own;
  PlanOptions path_options = options;
  path_options.keep_phases = false;
  return find_path(*in, query, path_options, report ? *report : own);
}

Result<double> Planner::certify_path(const motion::JointPath& path,
                                     const std::stop_token& token) const {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  return pipeline::certify_path(*compiled(), path, StopCondition::after(kForever, token));
}

}  // namespace tandem::pipeline
