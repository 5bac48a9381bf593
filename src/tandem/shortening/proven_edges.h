#pragma once
/// Proofs of a path's edges while it is shortened. Private to shortening/.

#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// Edges that cannot be proven free, by their first waypoint; all that are left on a stop.
std::vector<int> unproven_edges(const collision::BatchChecker& checker,
                                const collision::BatchPairs& pairs, const motion::JointPath& path,
                                collision::BatchChecker::Scratch& scratch,
                                const StopCondition& stop);

/// Moves waypoints at edges that cannot be proven towards those of `safe`, no further than needed;
/// in the worst case `path` becomes `safe`, whose edges are proven.
/// @return how many were moved.
int draw_back(const collision::BatchChecker& checker, const collision::BatchPairs& pairs,
              const motion::JointPath& safe, motion::JointPath& path,
              collision::BatchChecker::Scratch& scratch, const StopCondition& stop);

}  // namespace tandem::shortening
