#pragma once
/// Search for n arms at once, on the grids of all their pairs.

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

struct JointOptions {
  SearchOptions search = {};
  DiagramOptions diagram = {};
  double finest_step = 0.025;  ///< [s] The grids are halved no further, > 0.
  long most_nodes = 200000;    ///< Expanded per grid, > 0.
};

/// A* over places of a grid that every pair of arms may take at once: obstacles in the space of n
/// local times are cylinders over the diagrams of pairs. Guided by the longest of the ways that
/// pairs have left. Then pulled taut.
/// @return kCoordination, with the proof in words if blocked cells enclose the start or goal; the
/// stop's error.
Result<Schedule> search_jointly(const CoordinationProblem& problem, const JointOptions& options,
                                const StopCondition& stop);

}  // namespace tandem::coordination
