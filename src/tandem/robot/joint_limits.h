#pragma once
/// Overlay of MoveIt's joint_limits.yaml.

#include <filesystem>

#include "tandem/robot/model.h"

namespace tandem::robot {

/// Applies `joint_limits: {JOINT: {has_velocity_limits, max_velocity, ...}}` to `model`, position
/// overrides (min_position, max_position) included. has_x_limits: false removes a limit.
/// `joint_prefix` is put before no name of the file; names are those of the model.
/// @return kInvalidInput naming file, line, joint, key and value for unknown joints or keys and
/// values that are not positive numbers. The model is unchanged after an error.
Result<void> overlay_joint_limits(const std::filesystem::path& file, Model& model);

}  // namespace tandem::robot
