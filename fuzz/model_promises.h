#pragma once
/// What every robot::Model holds.

#include <cmath>

#include "support.h"

namespace tandem::fuzz {

inline void check_pose(const Eigen::Isometry3d& X) {
  require(X.matrix().allFinite(), "poses are finite");
  require((X.linear() * X.linear().transpose()).isIdentity(1e-9), "rotations are orthonormal");
  require(X.linear().determinant() > 0, "rotations do not mirror");
}

inline void check_limits(const robot::JointLimits& limits) {
  require(limits.lower <= limits.upper, "position limits are in order");
  require(limits.velocity > 0 && limits.acceleration > 0 && limits.jerk > 0, "limits are positive");
}

inline void check_geometry(const robot::Geometry& geometry) {
  check_pose(geometry.X_LG);
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (const auto* box = std::get_if<robot::BoxGeometry>(&geometry.shape)) {
    require(box->size.allFinite() && box->size.minCoeff() > 0, "boxes have positive sizes");
  } else if (const auto* sphere = std::get_if<robot::SphereGeometry>(&geometry.shape)) {
    require(positive(sphere->radius), "spheres have a positive radius");
  } else if (const auto* cylinder = std::get_if<robot::CylinderGeometry>(&geometry.shape)) {
    require(positive(cylinder->radius) && positive(cylinder->length),
            "cylinders have positive sizes");
  } else {
    require(std::get<robot::MeshGeometry>(geometry.shape).scale.allFinite(),
            "scales of meshes are finite");
  }
}

inline void check_joint(const robot::Model& model, std::size_t k) {
  const robot::Joint& joint = model.joints()[k];
  require(joint.child_link == static_cast<int>(k) + 1, "joint k carries link k + 1");
  require(joint.parent_link >= 0 && joint.parent_link < joint.child_link,
          "parents come before their children");
  require(model.find_joint(joint.name) == static_cast<int>(k), "names of joints are unique");
  check_pose(joint.X_PJ);
  check_limits(joint.limits);
  const bool moves = joint.type != robot::JointType::kFixed;
  if (moves) require(std::abs(joint.axis_J.norm() - 1) < 1e-9, "axes have length 1");
  require((joint.position_index >= 0) == (moves && !joint.mimic),
          "joints that move by themselves have a position");
  if (joint.position_index >= 0) {
    require(model.joint_of_position(joint.position_index) == static_cast<int>(k),
            "positions lead to their joint");
  }
  if (!joint.mimic) return;
  const auto source = static_cast<std::size_t>(joint.mimic->joint);
  require(source < model.joints().size() && model.joints()[source].position_index >= 0,
          "a joint follows one that moves by itself");
  require(std::isfinite(joint.mimic->multiplier) && std::isfinite(joint.mimic->offset),
          "a joint follows by finite numbers");
}

inline void check_model(const robot::Model& model) {
  require(model.links().size() == model.joints().size() + 1, "the model is one tree");
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    const robot::Link& link = model.links()[i];
    require(model.find_link(link.name) == static_cast<int>(i), "names of links are unique");
    for (const robot::Geometry& geometry : link.collision) check_geometry(geometry);
    for (const robot::Geometry& geometry : link.visual) check_geometry(geometry);
    if (link.inertial) check_pose(link.inertial->X_LI);
  }
  for (std::size_t k = 0; k < model.joints().size(); ++k) check_joint(model, k);
}

}  // namespace tandem::fuzz
