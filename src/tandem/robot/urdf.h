#pragma once
/// URDF reader.

#include <filesystem>

#include "tandem/robot/model.h"
#include "tandem/robot/package_path.h"

namespace tandem::robot {

/// Reads revolute, continuous, prismatic, fixed and mimic joints, limits, inertials, and box,
/// sphere, cylinder and mesh geometry. A mesh that is not found keeps an empty path and says where
/// it was looked for: whoever needs the mesh reports it. A velocity limit that is absent or 0
/// counts as none, as do soft limits of a safety_controller: narrow a range with an overlay.
/// Elements that URDF does not know (ros2_control, gazebo, transmission, ...) have no effect.
/// @return kNotFound or kIo for the file; kInvalidInput naming file, line where known, element and
/// value; kUnsupported for floating and planar joints.
Result<Model> load_urdf(const std::filesystem::path& file, const PackagePath& packages = {});
/// Same from text; `origin` stands for the file in messages, `base` resolves relative meshes.
Result<Model> parse_urdf(const std::string& text, const std::string& origin,
                         const std::filesystem::path& base, const PackagePath& packages = {});

}  // namespace tandem::robot
