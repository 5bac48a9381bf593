#pragma once
/// Why no way leads through a diagram.

#include <optional>

#include "tandem/coordination/diagram.h"

namespace tandem::coordination {

/// A connected wall of blocked cells between start and goal: in each of them one pair touches
/// everywhere, and no way leads around. So whatever the arms do, they deadlock.
struct Deadlock {
  std::vector<int> wall;  ///< Leaves of the diagram, of which neighbours share at least a corner.
  int pair = -1;          ///< The pair that touches in most of its area.
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< [s] Around the wall's cells in which `pair` touches.
};

/// Nothing if cells that are not blocked connect start and goal.
std::optional<Deadlock> find_deadlock(const CoordinationDiagram& diagram);

/// For a person: the pair and the local times, of a diagram of two arms.
std::string describe(const CoordinationDiagram& diagram, const Deadlock& deadlock);

}  // namespace tandem::coordination
