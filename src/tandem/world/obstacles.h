#pragma once
/// Obstacles that come and go.

#include "tandem/world/workcell.h"

namespace tandem::world {

/// The cell with one obstacle more, its last body.
/// @return kInvalidInput, as Workcell::make: a name that is taken, a body without shapes.
Result<std::shared_ptr<const Workcell>> with_obstacle(const Workcell& cell, ObstacleSpec obstacle);

/// The cell without an obstacle. Bodies behind it move up by one.
/// @return kNotFound with the nearest name; kInvalidInput if an arm carries it, or if the cell's
/// file or a query names it.
Result<std::shared_ptr<const Workcell>> without_obstacle(const Workcell& cell,
                                                         const std::string& name);

}  // namespace tandem::world
