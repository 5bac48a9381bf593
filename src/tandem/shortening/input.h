#pragma once
/// What every shortener asks of its input. Private to shortening/.

#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// Throws ContractViolation for fewer than two waypoints, wrong sizes, or options out of range.
void check_input(const world::Workcell& cell, const motion::JointPath& path,
                 const ShorteningOptions& options);

/// The pairs of `scope`, compiled up to `clearance` [m] at least.
collision::BatchChecker::Pairs pairs_within(const collision::CompiledCell& compiled,
                                            const world::PairScope& scope, double clearance);

/// The answer for a path without inner waypoints.
Shortening unchanged(const world::Workcell& cell, const motion::JointPath& path,
                     const ShorteningOptions& options);

}  // namespace tandem::shortening
