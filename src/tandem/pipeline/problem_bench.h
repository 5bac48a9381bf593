#pragma once
/// Path planning over sets of problems, and what it took: no timing, no trajectory.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// Two configurations of a cell with a path to be found between them.
struct BenchProblem {
  std::string set;     ///< The group that it is counted in.
  bool valid = true;   ///< Whether whoever made the set found both ends free; others are not run.
  ResolvedQuery ends;  ///< Its name is the problem's, unique in the set.
  /// Makes the cell, which has `ends` as its only query; called when the problem's turn comes.
  std::function<Result<std::shared_ptr<const world::Workcell>>()> cell;
};

/// One tried problem.
struct ProblemRun {
  int set = 0;  ///< Index into ProblemBenchResult::sets.
  std::string problem;
  int cycle = 0;
  bool solved = false;
  bool certified = false;                  ///< Every edge passed the continuous-time certificate.
  ErrorCode failure = ErrorCode::kNoPath;  ///< If not both.
  std::string message;
  double planning = 0, simplification = 0;     ///< Wall time [s].
  double length_before = 0, length_after = 0;  ///< Sum of Euclidean edge lengths [rad].
};

struct ProblemCount {
  std::string name;
  int problems = 0, valid = 0;
};

struct ProblemBenchResult {
  PlanOptions options;
  int cycles = 0;                  ///< As asked for.
  std::vector<ProblemCount> sets;  ///< In the order of the problems.
  std::vector<ProblemRun> runs;
  std::size_t planned_runs = 0;  ///< More than `runs` if it was stopped.
};

/// Runs every valid problem `cycles` times; cycle k uses seed options.seed + k. Times hold planning
/// and simplification only: not the making and compiling of the cell, nor the certificate of the
/// result, which is checked afresh whatever the planner did. Ends early, keeping what it has, when
/// options.token stops.
/// @param progress  called after every run with the runs done and the total.
/// @return the error of a cell that cannot be made, naming the problem.
Result<ProblemBenchResult> bench_problems(
    const std::vector<BenchProblem>& problems, int cycles, const PlanOptions& options,
    const std::function<void(const ProblemRun&, std::size_t done, std::size_t total)>& progress);

}  // namespace tandem::pipeline
