#pragma once
/// OMPL's RRTConnect and PathSimplifier behind tandem's interfaces.
///
/// Seeds: OMPL seeds every generator from a global count of constructions. Here every generator
/// that decides anything gets a seed of its own, so equal seeds give equal paths on any thread.
/// Console: the first call sets OMPL's process-wide log level to LOG_NONE, once; a program that
/// wants OMPL's messages sets the level again after that.

#include "tandem/planning/planner.h"

namespace tandem::planning {

struct OmplPlannerOptions {
  double range = 0;  ///< Longest tree edge [rad]; 0: OMPL's own (a fifth of the Euclidean extent).
};

/// Ref: Kuffner, LaValle, RRT-Connect (2000); OMPL's implementation. After a stop it frees its
/// tree, about 0.2 ms per thousand nodes.
std::unique_ptr<PathPlanner> make_ompl_rrt_connect(const OmplPlannerOptions& options = {});

/// OMPL's default sequence, `PathSimplifier::simplify`. Between its steps the path is kept if every
/// edge is accepted and it is no longer than the one kept before; the last one kept is the result.
/// So a stop, or an edge that is rejected although it is part of an accepted one (as samples do:
/// make_sampled_validity), costs the last steps only.
std::unique_ptr<PathSimplifier> make_ompl_simplifier();

}  // namespace tandem::planning
