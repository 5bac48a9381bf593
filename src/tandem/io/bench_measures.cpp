#include "tandem/io/bench_measures.h"

#include <algorithm>

namespace tandem::io {

using pipeline::BenchRun;
using pipeline::Statistics;

std::string failure_kind(ErrorCode code) {
  switch (code) {
    case ErrorCode::kCollision:
      return "collision";
    case ErrorCode::kCoordination:
      return "coordination";
    case ErrorCode::kLimits:
      return "limits";
    case ErrorCode::kTimeout:
      return "timeout";
    default:
      return "planning";
  }
}

Runs runs_of(const pipeline::BenchResult& result, const std::string& query) {
  Runs runs;
  for (const BenchRun& run : result.runs) {
    if (query.empty() || run.query == query) runs.push_back(&run);
  }
  return runs;
}

Runs successes(const Runs& runs) {
  Runs good;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(good),
               [](const BenchRun* run) { return run->success; });
  return good;
}

std::vector<std::string> query_names(const pipeline::BenchResult& result) {
  std::vector<std::string> names;
  for (const BenchRun& run : result.runs) {
    if (std::find(names.begin(), names.end(), run.query) == names.end()) {
      names.push_back(run.query);
    }
  }
  return names;
}

std::map<std::string, int> failures_by_kind(const Runs& runs) {
  std::map<std::string, int> counts;
  for (const char* kind : kFailureKinds) counts[kind] = 0;
  for (const BenchRun* run : runs) {
    if (!run->success) ++counts[failure_kind(run->failure)];
  }
  return counts;
}

std::map<std::string, int> rung_counts(const Runs& runs) {
  std::map<std::string, int> counts;
  for (const BenchRun* run : successes(runs)) {
    for (const auto& [rung, count] : run->report.rungs) counts[rung] += count;
  }
  return counts;
}

Statistics measure(const Runs& runs, const std::function<double(const BenchRun&)>& value) {
  std::vector<double> values;
  for (const BenchRun* run : successes(runs)) values.push_back(value(*run));
  return Statistics::of(std::move(values));
}

Statistics measure_ms(const Runs& runs, double pipeline::ModuleTimes::* module) {
  return measure(runs, [&](const BenchRun& run) { return run.report.times.*module * 1e3; });
}

Statistics measure_arm_ms(const Runs& runs, double pipeline::ModuleTimes::* module, int arm) {
  std::vector<double> values;
  for (const BenchRun* run : successes(runs)) {
    const std::vector<pipeline::ModuleTimes>& times = run->report.arm_times;
    if (!times.empty()) values.push_back(times.at(static_cast<std::size_t>(arm)).*module * 1e3);
  }
  return Statistics::of(std::move(values));
}

bool has_arm_times(const Runs& runs) {
  return std::ranges::any_of(successes(runs),
                             [](const BenchRun* run) { return !run->report.arm_times.empty(); });
}

Statistics measure_duration(const Runs& runs) {
  return measure(runs, [](const BenchRun& run) { return run.duration; });
}

Statistics measure_length(const Runs& runs, double pipeline::ArmLengths::* length, int arm) {
  return measure(runs, [&](const BenchRun& run) {
    const std::vector<pipeline::ArmLengths>& arms = run.report.arms;
    if (arm >= 0) return arms.at(static_cast<std::size_t>(arm)).*length;
    double sum = 0;
    for (const pipeline::ArmLengths& lengths : arms) sum += lengths.*length;
    return sum;
  });
}

}  // namespace tandem::io
