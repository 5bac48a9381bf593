#include "tandem/pipeline/problem_bench.h"

#include <algorithm>

#include "tandem/core/contract.h"
#include "tandem/pipeline/path.h"

namespace tandem::pipeline {

namespace {

/// Sets in the order of their first problems, and for each problem the index of its set.
std::vector<int> count_sets(const std::vector<BenchProblem>& problems,
                            std::vector<ProblemCount>& sets) {
  std::vector<int> set_of;
  for (const BenchProblem& problem : problems) {
    auto set = std::ranges::find(sets, problem.set, &ProblemCount::name);
    if (set == sets.end()) set = sets.insert(sets.end(), {problem.set, 0, 0});
    ++set->problems;
    if (problem.valid) ++set->valid;
    set_of.push_back(static_cast<int>(set - sets.begin()));
  }
  return set_of;
}

/// @return whether the run counts: not if it was stopped.
bool run_once(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
              const PlanOptions& options, ProblemRun& run) {
  PlanReport report;
  const auto failed = [&run](const Error& error) {
    run.failure = error.code;
    run.message = error.message;
    return error.code != ErrorCode::kCancelled;
  };
  const auto found = find_path(compiled, ends, options, report);
  run.planning = report.times.path_planning;
  run.simplification = report.times.simplification;
  if (!found) return failed(found.error());
  run.solved = true;
  run.length_before = motion::joint_length(found->planned);
  run.length_after = motion::joint_length(found->path);
  constexpr double kForever = std::numeric_limits<double>::infinity();
  const auto clearance =
      certify_path(compiled, found->path, StopCondition::after(kForever, options.token));
  if (!clearance) return failed(clearance.error());
  run.certified = true;
  return true;
}

}  // namespace

Result<ProblemBenchResult> bench_problems(
    const std::vector<BenchProblem>& problems, int cycles, const PlanOptions& options,
    const std::function<void(const ProblemRun&, std::size_t done, std::size_t total)>& progress) {
  expects(cycles > 0, "bench_problems needs at least one cycle");
  expects(options.deadline > 0, "the deadline must be positive");
  ProblemBenchResult result{options, cycles, {}, {}, 0};
  const std::vector<int> set_of = count_sets(problems, result.sets);
  for (const ProblemCount& set : result.sets) {
    result.planned_runs += static_cast<std::size_t>(set.valid) * static_cast<std::size_t>(cycles);
  }
  PlanOptions run_options = options;
  run_options.keep_phases = false;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const BenchProblem& problem = problems[i];
    if (!problem.valid) continue;
    if (options.token.stop_requested()) return result;
    const auto cell = problem.cell();
    if (!cell) {
      return fail(cell.error().code, "problem '" + problem.ends.name + "' of set '" + problem.set +
                                         "': " + cell.error().message);
    }
    const collision::CompiledCell compiled(*cell);
    prepare_modules(options.preset, compiled);
    for (int cycle = 0; cycle < cycles; ++cycle) {
      run_options.seed = options.seed + static_cast<std::uint64_t>(cycle);
      ProblemRun run{.set = set_of[i], .problem = problem.ends.name, .cycle = cycle, .message = {}};
      if (!run_once(compiled, problem.ends, run_options, run)) return result;
      result.runs.push_back(std::move(run));
      if (progress) progress(result.runs.back(), result.runs.size(), result.planned_runs);
    }
  }
  return result;
}

}  // namespace tandem::pipeline
