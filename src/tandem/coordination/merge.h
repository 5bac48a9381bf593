#pragma once
/// Two tracks become one: n arms are coordinated two groups at a time.

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

/// The tracks of a diagram along a way through it, as one track: its arms are those of x, then y.
/// @param points  from (0, 0) to the goal, in units of the diagram.
Track merge(const CoordinationDiagram& diagram, const std::vector<GridPoint>& points);

/// The schedule of a track that holds all arms, in the order of the cell.
Schedule schedule_of(const Track& track);

}  // namespace tandem::coordination
