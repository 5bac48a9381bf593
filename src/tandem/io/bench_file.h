#pragma once
/// Bench results as JSON and as a table. The keys are on docs/schemas.md.

#include <string>

#include "tandem/pipeline/bench.h"

namespace tandem::io {

std::string bench_json(const pipeline::BenchResult& result);
std::string bench_table(const pipeline::BenchResult& result);

}  // namespace tandem::io
