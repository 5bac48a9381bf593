#pragma once
/// Pairs that one or two joints decide, proven apart ahead of time. Private to this folder.

#include "tandem/collision/batch_model.h"

namespace tandem::collision {

/// Proves for every two groups with pairs in the checker's cell whose relative pose one or two
/// joints decide (a forearm and the hand below it) where in these joints' values nothing of them
/// touches: BatchModel::joint_maps. Most of an arm's configurations keep such neighbours near each
/// other but apart, where spheres around them tell nothing.
/// @param model  that of `checker`, which needs no maps yet.
/// Ref: docs/methods.md, "Batches".
std::vector<JointMap> prove_joint_maps(const BatchChecker& checker, const BatchModel& model);

}  // namespace tandem::collision
