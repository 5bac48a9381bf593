#pragma once
/// Repeated cycles over a cell's queries, and their statistics.

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// Statistics of a sample. All 0 for an empty one. Percentiles interpolate linearly.
struct Statistics {
  double mean = 0, std = 0, p50 = 0, p95 = 0, p99 = 0, max = 0;
  static Statistics of(std::vector<double> values);
};

/// One tried query.
struct BenchRun {
  std::string query;
  int cycle = 0;
  bool success = false;
  ErrorCode failure = ErrorCode::kNoPath;  ///< If not successful.
  std::string message;
  double duration = 0;  ///< [s] of the motion
  PlanReport report;
};

struct BenchResult {
  std::string workcell;
  PlanOptions options;
  int cycles = 0;  ///< Completed.
  std::vector<std::string> arms;
  std::vector<BenchRun> runs;
  std::string list = {};  ///< Of the cell's lists; empty: its `queries`.
};

/// Runs all queries of a list `cycles` times; run k uses seed options.seed + k. After a failed
/// query the next one starts from the intended goal, in the scene intended there; every cycle
/// starts from the cell's file. Cells are
/// compiled before, outside of all times. Ends early, keeping what it has, when options.token
/// stops.
/// @param progress  called after every run with the runs done and the total.
/// @param list  name of one of the cell's lists; "" for its `queries`.
Result<BenchResult> bench(const std::shared_ptr<const world::Workcell>& cell, int cycles,
                          const PlanOptions& options,
                          const std::function<void(const BenchRun&, int done, int total)>& progress,
                          std::string_view list = {});

}  // namespace tandem::pipeline
