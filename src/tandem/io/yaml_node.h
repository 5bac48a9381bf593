#pragma once
/// A YAML file as a plain tree in which every node knows its place. Not part of the public
/// interface.

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::io {

/// Ends the reading of a file. It never leaves io/: `read_yaml` turns it into a Result, so that the
/// reading code is a plain list of what a file holds.
struct YamlError {
  Error error;
};

/// The value, or the end of reading with the same error.
template <class T>
T take(Result<T> result) {
  if (!result) throw YamlError{std::move(result.error())};
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// Every member throws YamlError "FILE:LINE:COL: what; remedy" where the file does not hold what is
/// asked for.
class YamlNode {
 public:
  enum class Kind { kNull, kScalar, kList, kMap };

  /// Anchors are expanded; tags, repeated keys and further documents are refused.
  static YamlNode load(const std::filesystem::path& file);

  Kind kind() const { return kind_; }
  /// The key it belongs to, e.g. "radius" or "xyz[1]".
  const std::string& label() const { return label_; }
  std::string where() const;  ///< "FILE:LINE:COL"
  [[noreturn]] void refuse(const std::string& message,
                           ErrorCode code = ErrorCode::kInvalidInput) const;
  /// The value, or the end of reading with the error placed here.
  template <class T>
  T check(Result<T> result) const {
    if (!result) refuse(label_ + ": " + result.error().message, result.error().code);
    return std::move(*result);
  }

  /// Refuses keys that are not `known`, with the nearest one that is.
  void only(const std::vector<std::string>& known) const;
  const YamlNode& at(std::string_view key) const;    ///< Must exist.
  const YamlNode* find(std::string_view key) const;  ///< nullptr if there is none.
  /// Which one of `choices` the map has; must be exactly one.
  const std::string& one_of(const std::vector<std::string>& choices) const;
  /// Keys and values of a map, in the order of the file.
  std::vector<std::pair<std::string, const YamlNode*>> entries() const;
  /// Refuses a key of this map, at its place.
  [[noreturn]] void refuse_key(std::string_view key, const std::string& message,
                               ErrorCode code = ErrorCode::kInvalidInput) const;

  const std::vector<YamlNode>& items() const;  ///< Of a list.
  std::string text() const;                    ///< Not empty.
  double number() const;                       ///< Finite.
  double positive() const;
  double not_negative() const;
  Eigen::VectorXd numbers() const;
  Eigen::VectorXd numbers(Eigen::Index count) const;  ///< Exactly so many.

 private:
  friend class YamlTreeBuilder;
  struct Key {
    std::string name;
    int line, column;
  };

  const char* kind_name() const;
  void expect(Kind kind, const char* name) const;
  std::string place(int line, int column) const;

  Kind kind_ = Kind::kNull;
  std::string label_;
  std::shared_ptr<const std::string> file_;
  int line_ = 0, column_ = 0;  // From 1.
  std::string scalar_;
  std::vector<Key> keys_;  // Of a map, one per child.
  std::vector<YamlNode> children_;
  std::size_t size_ = 1, levels_ = 1;  // Nodes and levels of this subtree.
};

/// Reads a file with `read(const YamlNode& root)`.
template <class Read>
auto read_yaml(const std::filesystem::path& file, Read read)
    -> Result<decltype(read(std::declval<const YamlNode&>()))> {
  try {
    return read(YamlNode::load(file));
  } catch (const YamlError& error) {
    return std::unexpected(error.error);
  }
}

}  // namespace tandem::io
