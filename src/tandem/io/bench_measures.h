#pragma once
/// What a bench measures, for the file and for the table.

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tandem/io/report_keys.h"
#include "tandem/pipeline/bench.h"

namespace tandem::io {

using Runs = std::vector<const pipeline::BenchRun*>;

inline constexpr std::array<const char*, 5> kFailureKinds = {"planning", "collision",
                                                             "coordination", "limits", "timeout"};
/// One of kFailureKinds: everything that ends before there is a curve counts as planning.
std::string failure_kind(ErrorCode code);

/// Runs of one query, or of all if `query` is empty.
Runs runs_of(const pipeline::BenchResult& result, const std::string& query = {});
Runs successes(const Runs& runs);
/// Query names in the order in which they were first run.
std::vector<std::string> query_names(const pipeline::BenchResult& result);
/// Failures by kind, kinds without one included.
std::map<std::string, int> failures_by_kind(const Runs& runs);
/// Rungs taken by successful runs.
std::map<std::string, int> rung_counts(const Runs& runs);

/// Statistics of `value` over successful runs.
pipeline::Statistics measure(const Runs& runs,
                             const std::function<double(const pipeline::BenchRun&)>& value);
/// Of a module's wall time [ms].
pipeline::Statistics measure_ms(const Runs& runs, double pipeline::ModuleTimes::* module);
/// The same of arm `arm` alone, over the runs that planned it so.
pipeline::Statistics measure_arm_ms(const Runs& runs, double pipeline::ModuleTimes::* module,
                                    int arm);
/// Whether a successful run planned arms alone.
bool has_arm_times(const Runs& runs);
/// Of the motion's duration [s].
pipeline::Statistics measure_duration(const Runs& runs);
/// Of a length of arm `arm`, or of its sum over all arms if -1.
pipeline::Statistics measure_length(const Runs& runs, double pipeline::ArmLengths::* length,
                                    int arm = -1);

}  // namespace tandem::io
