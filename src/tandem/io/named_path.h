#pragma once
/// Files and folders that a YAML file names. Not part of the public interface.

#include <filesystem>
#include <string>

#include "tandem/io/yaml_node.h"
#include "tandem/robot/package_path.h"

namespace tandem::io {

/// `text` with an environment variable at its beginning replaced: "$NAME/rest" or "${NAME}/rest".
/// @return kInvalidInput or kNotFound saying what to do if the variable is malformed or not set.
Result<std::string> expand_variable(const std::string& text);

/// Finds what the nodes of one file name: relative to the file's folder, absolute, in a package
/// ("package://NAME/rest"), or below the folder in an environment variable ("$NAME/rest"), which,
/// if relative, is relative to the current folder.
class NamedPaths {
 public:
  NamedPaths(std::filesystem::path folder, robot::PackagePath packages)
      : folder_(std::move(folder)), packages_(std::move(packages)) {}

  std::filesystem::path file(const YamlNode& node) const { return find(node, false); }
  std::filesystem::path folder(const YamlNode& node) const { return find(node, true); }
  const robot::PackagePath& packages() const { return packages_; }

 private:
  std::filesystem::path find(const YamlNode& node, bool folder) const;

  std::filesystem::path folder_;
  robot::PackagePath packages_;
};

}  // namespace tandem::io
