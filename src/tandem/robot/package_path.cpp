#include "tandem/robot/package_path.h"

#include <cstdlib>
#include <string_view>

namespace tandem::robot {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& path) {
  std::error_code unreadable_counts_as_absent;
  return fs::exists(path, unreadable_counts_as_absent);
}

/// Name of a folder's last component, with or without a slash at the end.
fs::path folder_name(const fs::path& folder) {
  return folder.has_filename() ? folder.filename() : folder.parent_path().filename();
}

}  // namespace

PackagePath PackagePath::with_environment(std::vector<fs::path> folders) {
  const char* variable = std::getenv("ROS_PACKAGE_PATH");
  std::string_view rest = variable ? variable : "";
  while (!rest.empty()) {
    const std::size_t length = std::min(rest.find(':'), rest.size());
    if (length > 0) folders.emplace_back(rest.substr(0, length));
    rest.remove_prefix(std::min(length + 1, rest.size()));
  }
  return PackagePath(std::move(folders));
}

Result<fs::path> PackagePath::resolve(const std::string& uri, const fs::path& base) const {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  if (!uri.starts_with(kPackage)) {
    const bool is_file = uri.starts_with(kFile);
    if (!is_file && uri.find("://") != std::string::npos) {
      return fail(ErrorCode::kUnsupported,
                  "'" + uri + "': only package:// and file:// URIs and plain paths are read");
    }
    const fs::path path = is_file ? fs::path(uri.substr(kFile.size())) : base / uri;
    if (is_file && !path.is_absolute()) {
      return fail(ErrorCode::kInvalidInput, "'" + uri + "': file:// needs an absolute path");
    }
    if (!is_there(path)) {
      return fail(ErrorCode::kNotFound, "'" + uri + "': no file " + path.string());
    }
    return path;
  }

  const std::string rest = uri.substr(kPackage.size());
  const std::size_t slash = rest.find('/');
  const std::string name = rest.substr(0, slash);
  if (name.empty() || slash == std::string::npos || slash + 1 == rest.size()) {
    return fail(ErrorCode::kInvalidInput, "'" + uri + "': expected package://NAME/PATH");
  }
  const std::string file = rest.substr(slash + 1);
  std::string searched;
  for (const fs::path& folder : folders_) {
    searched += (searched.empty() ? "" : ", ") + folder.string();
    const bool is_package = folder_name(folder) == name;
    for (const fs::path& package : {folder / name, is_package ? folder : fs::path()}) {
      if (!package.empty() && is_there(package / file)) return package / file;
    }
  }
  return fail(ErrorCode::kNotFound,
              "'" + uri + "': no " + name + "/" + file + " in " +
                  (searched.empty() ? "the package folders, as none are given" : searched) +
                  "; add the folder that holds " + name + " to the search path");
}

}  // namespace tandem::robot
