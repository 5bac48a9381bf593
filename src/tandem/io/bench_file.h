#pragma once
/// Bench results as JSON and as a table. The keys are on docs/schemas.md.

#include <string>

#include "tandem/pipeline/bench.h"

namespace tandem::io {

/// Statistics are over successful runs; failures are counted by kind.
std::string bench_json(const pipeline::BenchResult& result);

/// The same for people: one row per module and measure, then failures, rungs and queries.
std::string bench_table(const pipeline::BenchResult& result);

}  // namespace tandem::io
