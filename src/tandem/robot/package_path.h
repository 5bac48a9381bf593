#pragma once
/// Where package:// URIs point to.

#include <filesystem>
#include <string>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::robot {

/// Folders in which ROS packages are looked for, first match wins.
class PackagePath {
 public:
  PackagePath() = default;
  explicit PackagePath(std::vector<std::filesystem::path> folders) : folders_(std::move(folders)) {}
  /// `folders`, then those of the environment's ROS_PACKAGE_PATH (':'-separated).
  static PackagePath with_environment(std::vector<std::filesystem::path> folders = {});

  /// @param uri   package://NAME/rest, file:///abs, absolute, or relative to `base`.
  /// @return the file's path; kNotFound naming the folders that were searched. NAME matches a
  /// folder NAME below (or named NAME among) the search folders.
  Result<std::filesystem::path> resolve(const std::string& uri,
                                        const std::filesystem::path& base) const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace tandem::robot
