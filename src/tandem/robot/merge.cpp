#include "tandem/core/contract.h"
#include "tandem/robot/model.h"

namespace tandem::robot {

namespace {

constexpr const char* kWorld = "world";

}  // namespace

Result<Model> merge(std::string name, const std::vector<Placement>& placements) {
  std::vector<Link> links(1);
  std::vector<Joint> joints;
  links[0].name = kWorld;
  for (const Placement& placement : placements) {
    expects(placement.model != nullptr, "placement.model is given");
    const Model& model = *placement.model;
    expects(!model.links().empty(), "placement.model was made by Model::make");
    const Link& root = model.links()[0];
    const bool is_common_root = placement.prefix.empty() && root.name == kWorld;
    if (is_common_root && !placement.X_WB.isApprox(Eigen::Isometry3d::Identity(), 1e-12)) {
      return fail(ErrorCode::kInvalidInput,
                  "robot '" + model.name() +
                      "': its root link 'world' is the world itself and cannot be placed "
                      "elsewhere; give the robot a name prefix or leave out its pose");
    }
    // The new index of the model's link i > 0 is first_link + i.
    const int first_link = static_cast<int>(links.size()) - (is_common_root ? 1 : 0);
    const int root_index = is_common_root ? 0 : first_link;
    if (is_common_root) {
      Link& world = links[0];
      world.collision.insert(world.collision.end(), root.collision.begin(), root.collision.end());
      world.visual.insert(world.visual.end(), root.visual.begin(), root.visual.end());
      if (root.inertial) world.inertial = root.inertial;
    } else {
      Joint weld;
      weld.name = "world_to_" + placement.prefix + root.name;
      weld.parent_link = 0;
      weld.child_link = root_index;
      weld.X_PJ = placement.X_WB;
      joints.push_back(std::move(weld));
    }
    for (std::size_t i = is_common_root ? 1 : 0; i < model.links().size(); ++i) {
      links.push_back(model.links()[i]);
      links.back().name = placement.prefix + links.back().name;
    }
    const int first_joint = static_cast<int>(joints.size());
    for (Joint joint : model.joints()) {
      joint.name = placement.prefix + joint.name;
      joint.parent_link = joint.parent_link == 0 ? root_index : first_link + joint.parent_link;
      joint.child_link += first_link;
      if (joint.mimic) joint.mimic->joint += first_joint;
      joints.push_back(std::move(joint));
    }
  }
  return Model::make(std::move(name), std::move(links), std::move(joints));
}

}  // namespace tandem::robot
