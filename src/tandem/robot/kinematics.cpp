#include "tandem/robot/kinematics.h"

#include <algorithm>

#include "tandem/core/contract.h"
#include "tandem/robot/joint_motion.h"

namespace tandem::robot {

void forward_kinematics(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& positions,
                        LinkPoses& X_WL) {
  expects(positions.size() == model.position_count(), "positions.size() == position_count()");
  const std::vector<Joint>& joints = model.joints();
  if (X_WL.size() != model.links().size()) {
    X_WL.assign(model.links().size(), Eigen::Isometry3d::Identity());
  }
  if (!X_WL.empty()) X_WL[0].setIdentity();
  for (const Joint& joint : joints) {
    place_child(joint, joint_value(joints, joint, positions), X_WL);
  }
}

void jacobian(const Model& model, const LinkPoses& X_WL, int link, const Eigen::Vector3d& p_WP,
              std::span<const int> columns,
              Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> J_W) {
  expects(X_WL.size() == model.links().size(), "X_WL has one pose per link");
  expects(link >= 0 && link < static_cast<int>(X_WL.size()), "link is one of the model's");
  expects(J_W.cols() == static_cast<Eigen::Index>(columns.size()), "J_W has a column per column");
  const std::vector<Link>& links = model.links();
  const std::vector<Joint>& joints = model.joints();
  J_W.setZero();
  int above = links[static_cast<std::size_t>(link)].parent_joint;
  while (above >= 0) {
    const Joint& joint = joints[static_cast<std::size_t>(above)];
    above = links[static_cast<std::size_t>(joint.parent_link)].parent_joint;
    if (joint.type == JointType::kFixed) continue;
    const auto found = std::ranges::find(columns, driving_position(joints, joint));
    if (found == columns.end()) continue;
    add_joint_column(joint, X_WL[static_cast<std::size_t>(joint.child_link)], p_WP,
                     J_W.col(found - columns.begin()));
  }
}

}  // namespace tandem::robot
