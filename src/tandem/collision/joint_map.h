#pragma once
/// Pairs that one or two joints decide, proven apart ahead of time. Private to this folder.

#include "tandem/collision/batch_model.h"

namespace tandem::collision {

/// A map with all that it follows from: where this is the same, so is the map.
struct JointRooms {
  /// What moves the groups against each other, from the joint that both hang from.
  struct Step {
    bool prismatic;
    double multiplier, offset, lower, upper;
    Eigen::Matrix4d X_PJ;
    bool operator==(const Step&) const = default;
  };
  std::vector<Step> down_a, down_b;
  std::vector<std::vector<BatchShape>> bodies;  ///< Of both groups; `joint` tells which.
  std::vector<Vector3f3> vertices;              ///< Of all these.
  std::vector<std::array<int, 2>> pairs;        ///< Of these.

  std::vector<std::int8_t> room;  ///< See JointMap::room.

  bool follows_from_the_same(const JointRooms& other) const {
    return down_a == other.down_a && down_b == other.down_b && bodies == other.bodies &&
           vertices == other.vertices && pairs == other.pairs;
  }
};

/// Proves for every two groups with pairs in the checker's cell whose relative pose one or two
/// joints decide (a forearm and the hand below it) where in these joints' values nothing of them
/// touches. Most of an arm's configurations keep such neighbours near each other but apart, where
/// spheres around them tell nothing.
/// @param model  that of `checker`, which needs no maps yet.
/// @param known  of this or other cells: taken where they follow from the same.
/// Ref: docs/methods.md, "Batches".
JointMaps prove_joint_maps(const BatchChecker& checker, const BatchModel& model,
                           JointMaps known = {});

}  // namespace tandem::collision
