#include "tandem/collision/ssv_model.h"

#include <algorithm>
#include <cmath>

#include "tandem/collision/link_frame.h"
#include "tandem/collision/ssv_field.h"
#include "tandem/collision/ssv_known.h"

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Compiles the joints: those that no arm moves become constants.
std::vector<LinkFrame> add_joints(const world::Workcell& cell, SsvModel& model) {
  const robot::Model& robot = cell.model();
  const std::vector<int> columns = columns_of_positions(cell);
  Eigen::VectorXd positions;
  cell.positions(Eigen::VectorXd::Zero(cell.dof()), positions);
  std::vector<LinkFrame> frames(robot.links().size());
  for (std::size_t l = 0; l < frames.size(); ++l) {
    const int joint_index = robot.links()[l].parent_joint;
    if (joint_index < 0) continue;
    const robot::Joint& joint = robot.joints()[static_cast<std::size_t>(joint_index)];
    const LinkFrame& parent = frames[static_cast<std::size_t>(joint.parent_link)];
    const Isometry3d X_PJ = parent.X_JL * joint.X_PJ;
    const robot::Joint& source =
        joint.mimic ? robot.joints()[static_cast<std::size_t>(joint.mimic->joint)] : joint;
    const double multiplier = joint.mimic ? joint.mimic->multiplier : 1.0;
    const double offset = joint.mimic ? joint.mimic->offset : 0.0;
    const int position = joint.type == robot::JointType::kFixed ? -1 : source.position_index;
    const int column = position < 0 ? -1 : columns[static_cast<std::size_t>(position)];
    if (column < 0) {
      const double value = position < 0 ? 0.0 : multiplier * positions[position] + offset;
      frames[l] = {parent.joint, X_PJ * joint_motion(joint, value)};
      continue;
    }
    const Matrix3d R_JA =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), joint.axis_J).toRotationMatrix();
    SsvJoint compiled{parent.joint, model.depth_of(parent.joint) + 1,
                      X_PJ,         joint.type == robot::JointType::kPrismatic,
                      column,       multiplier,
                      offset};
    compiled.X_PJ.linear() = X_PJ.linear() * R_JA;
    model.depth = std::max(model.depth, compiled.depth);
    frames[l].joint = static_cast<int>(model.joints.size());
    frames[l].X_JL.linear() = R_JA.transpose();
    model.joints.push_back(compiled);
  }
  return frames;
}

int common_joint(const SsvModel& model, int a, int b) {
  // Parents come first, so the later of two joints is never above the other.
  while (a != b) {
    int& later = a > b ? a : b;
    later = model.joints[static_cast<std::size_t>(later)].parent;
  }
  return a;
}

}  // namespace

namespace {

bool any_solid(const world::Workcell& cell) {
  return std::ranges::any_of(cell.bodies(), [](const world::Body& body) {
    return std::ranges::any_of(body.surfaces_L, [](const geometry::PlacedSurface& placed) {
      return placed.surface->is_closed();
    });
  });
}

}  // namespace

SsvModel::SsvModel(const world::Workcell& cell, const SsvChecker* like) : dof(cell.dof()) {
  frames = add_joints(cell, *this);
  with_anchors = any_solid(cell);
  SsvKnown known(like);
  for (const world::Body& body : cell.bodies()) {
    const LinkFrame& frame = frames[static_cast<std::size_t>(body.link)];
    if (known.add(body, frame, *this)) continue;
    add_body(body, frame.joint, frame.X_JL, with_anchors, *this);
  }
  nodes.shrink_to_fit();
  add_pairs(cell);
}

void SsvModel::add_pairs(const world::Workcell& cell) {
  pairs.reserve(cell.pairs().size());
  for (const world::BodyPair& pair : cell.pairs()) {
    const SsvBody& a = bodies[static_cast<std::size_t>(pair.a)];
    const SsvBody& b = bodies[static_cast<std::size_t>(pair.b)];
    const int common = a.joint < 0 || b.joint < 0 ? -1 : common_joint(*this, a.joint, b.joint);
    pairs.push_back({a.root, b.root, pair.a, pair.b, common, depth_of(common), a.joint == common,
                     b.joint == common, a.is_solid || b.is_solid});
  }
  field = std::make_shared<const SsvField>(*this);
}

}  // namespace tandem::collision
