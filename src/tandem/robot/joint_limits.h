#pragma once
/// Overlay of MoveIt's joint_limits.yaml.

#include <filesystem>
#include <string>

#include "tandem/robot/model.h"

namespace tandem::robot {

/// Applies `joint_limits: {JOINT: {has_velocity_limits, max_velocity, ...}}` to `model`; so do
/// acceleration, jerk, and position (has_position_limits, min_position, max_position). A value
/// replaces that of the model; has_x_limits: false removes the limit, whatever value stands beside
/// it. Names are those of the model. Scaling factors and effort limits have no effect.
/// @return kNotFound or kIo for the file; kInvalidInput naming file, line, joint, key and value for
/// unknown joints or keys and values that are not positive numbers. The model is unchanged after an
/// error.
Result<void> overlay_joint_limits(const std::filesystem::path& file, Model& model);
/// Same from text; `origin` stands for the file in messages.
Result<void> parse_joint_limits(const std::string& text, const std::string& origin, Model& model);

}  // namespace tandem::robot
