#pragma once
/// Results over problem sets as JSON and as a table. The keys are on docs/schemas.md.

#include <string>

#include "tandem/pipeline/problem_bench.h"

namespace tandem::io {

/// Statistics are over solved runs; every run that is not solved and certified is in `failures`.
std::string problem_bench_json(const pipeline::ProblemBenchResult& result);

/// The same for people: a row per set and measure, then failures by kind.
/// @param list_failures  names each failed run and why.
std::string problem_bench_table(const pipeline::ProblemBenchResult& result, bool list_failures);

}  // namespace tandem::io
