#pragma once
/// Workcell files. The schema is docs/workcell.md.

#include <filesystem>
#include <memory>
#include <vector>

#include "tandem/robot/package_path.h"
#include "tandem/world/workcell.h"

namespace tandem::io {

/// Reads the workcell, the robots it names (paths relative to the file) and their overlays.
/// @param packages  folders for package:// URIs; ROS_PACKAGE_PATH is searched after them.
/// @return kNotFound, kIo or kInvalidInput with file, line, key, value and remedy.
Result<std::shared_ptr<const world::Workcell>> load_workcell(
    const std::filesystem::path& file, const std::vector<std::filesystem::path>& packages = {});

/// The spec alone, before Workcell::make.
Result<world::WorkcellSpec> load_workcell_spec(
    const std::filesystem::path& file, const std::vector<std::filesystem::path>& packages = {});

/// Swept sphere volumes of a robot by link name. The schema is docs/workcell.md.
Result<std::map<std::string, std::vector<geometry::Shape>>> load_volumes(
    const std::filesystem::path& file, const robot::Model& model);

}  // namespace tandem::io
