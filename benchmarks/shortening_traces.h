#pragma once
/// Tool paths of plans, as numbers and as a picture.

#include <string_view>
#include <vector>

#include "tandem/tandem.h"

namespace tandem {

/// Tool poses at the waypoints, by arm.
std::vector<std::vector<Eigen::Isometry3d>> tool_poses(const world::Workcell& cell,
                                                       const motion::JointPath& path);

/// Prints an SVG with the tools' paths of a query through the phases of planning.
/// @return a program's exit code.
int print_traces(const std::shared_ptr<const world::Workcell>& cell, std::string_view query);

}  // namespace tandem
