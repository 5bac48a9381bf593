#pragma once
/// Where the tools are along a path.

#include <span>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::world {

/// X_WE at every waypoint, by arm.
/// @param path  of cell.dof() joint values each.
std::vector<std::vector<Eigen::Isometry3d>> tool_poses(const Workcell& cell,
                                                       std::span<const Eigen::VectorXd> path);

}  // namespace tandem::world
