#include "tandem/world/tool_poses.h"

namespace tandem::world {

std::vector<std::vector<Eigen::Isometry3d>> tool_poses(const Workcell& cell,
                                                       std::span<const Eigen::VectorXd> path) {
  std::vector<std::vector<Eigen::Isometry3d>> tools(cell.arms().size());
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  for (const Eigen::VectorXd& q : path) {
    cell.forward_kinematics(q, positions, X_WL);
    for (std::size_t i = 0; i < tools.size(); ++i) {
      tools[i].push_back(cell.tool_pose(static_cast<int>(i), X_WL));
    }
  }
  return tools;
}

}  // namespace tandem::world
