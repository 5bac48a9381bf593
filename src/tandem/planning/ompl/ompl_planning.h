#pragma once
/// OMPL's RRTConnect and PathSimplifier behind tandem's interfaces.

#include "tandem/planning/planner.h"

namespace tandem::planning {

struct OmplPlannerOptions {
  double range = 0;  ///< Longest tree edge [rad]; 0: OMPL's own (a fifth of the Euclidean extent).
};

/// Ref: Kuffner, LaValle, RRT-Connect (2000); OMPL's implementation.
std::unique_ptr<PathPlanner> make_ompl_rrt_connect(const OmplPlannerOptions& options = {});

/// OMPL's PathSimplifier::simplifyMax-like default sequence (`simplify`).
std::unique_ptr<PathSimplifier> make_ompl_simplifier();

}  // namespace tandem::planning
