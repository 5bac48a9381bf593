#pragma once
/// The path length post-processor by NLopt's SLSQP: the paper's choice, kept as the reference.

#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// All inner waypoints at once, one constraint per waypoint on the least distance, objective and
/// constraints scaled as in the paper: f by its first value, distances by the clearance. Edges are
/// not looked at, so `points_per_edge` must be empty. `tolerance` is the paper's relative function
/// tolerance. Its result may lack clearance whatever its return code says: see
/// Shortening::violation. Ref: the paper, "Path Length Post-Processor" and "Planner Parameters".
std::unique_ptr<Shortener> make_slsqp_shortener();

}  // namespace tandem::shortening
