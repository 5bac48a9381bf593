#pragma once
/// Time optimisation by NLopt's SLSQP: the paper's choice, kept as the reference.

#include "tandem/trajectory/time_optimizer.h"

namespace tandem::trajectory {

/// Minimises the sum of durations subject to the limits at knots and velocity peaks, with analytic
/// gradients; relative function tolerance 1e-3. The result is rescaled if SLSQP left it infeasible,
/// whatever its return code.
std::unique_ptr<TimeOptimizer> make_slsqp_time_optimizer();

}  // namespace tandem::trajectory
