#include "tandem/pipeline/bench.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/pipeline/planner.h"

namespace tandem::pipeline {

Statistics Statistics::of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  Statistics s;
  for (const double v : values) s.mean += v / n;
  for (const double v : values) s.std += (v - s.mean) * (v - s.mean);
  s.std = values.size() > 1 ? std::sqrt(s.std / (n - 1)) : 0.0;
  const auto percentile = [&](double p) {
    const double rank = p * (n - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    const double fraction = rank - static_cast<double>(below);
    return values[below] + fraction * (values[above] - values[below]);
  };
  s.p50 = percentile(0.50);
  s.p95 = percentile(0.95);
  s.p99 = percentile(0.99);
  s.max = values.back();
  return s;
}

Result<BenchResult> bench(const std::shared_ptr<const world::Workcell>& cell, int cycles,
                          const PlanOptions& options,
                          const std::function<void(const BenchRun&, int done, int total)>& progress,
                          std::string_view list) {
  expects(cell != nullptr, "bench needs a workcell");
  expects(cycles > 0, "bench needs at least one cycle");
  const auto asked = cell->find_list(list);
  if (!asked) return std::unexpected(asked.error());
  if ((*asked)->empty()) {
    return fail(ErrorCode::kInvalidInput,
                "workcell '" + cell->name() + "' has no queries" +
                    (list.empty() ? "; add `queries:` to bench it"
                                  : " in list '" + std::string(list) + "'; add some to bench it"));
  }
  // Each query starts from the intended goal of the one before, and in the scene intended there, so
  // all ends and scenes are known beforehand.
  const Planner planner(cell);
  const auto queries = planner.resolve_all(
      **asked, options.seed,
      StopCondition::after(std::numeric_limits<double>::infinity(), options.token));
  if (!queries) return std::unexpected(queries.error());
  for (const ResolvedQuery& query : *queries) planner.prepare(query.cell, options);

  BenchResult result{cell->name(), options, 0, {}, {}, std::string(list)};
  for (const world::Arm& arm : cell->arms()) result.arms.push_back(arm.name);
  const int total = cycles * static_cast<int>(queries->size());
  PlanOptions run_options = options;
  run_options.keep_phases = false;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    for (const ResolvedQuery& query : *queries) {
      run_options.seed = options.seed + result.runs.size();
      BenchRun run;
      run.query = query.name;
      run.cycle = cycle;
      const auto planned = planner.plan(query, run_options, &run.report);
      if (!planned && planned.error().code == ErrorCode::kCancelled) return result;
      run.success = planned.has_value();
      if (planned) {
        run.duration = planned->trajectory.duration();
      } else {
        run.failure = planned.error().code;
        run.message = planned.error().message;
      }
      result.runs.push_back(std::move(run));
      if (progress) progress(result.runs.back(), static_cast<int>(result.runs.size()), total);
    }
    ++result.cycles;
  }
  return result;
}

}  // namespace tandem::pipeline
