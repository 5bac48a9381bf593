#pragma once
/// Strict reading of JSON: every refusal names the key, the value and what was expected.

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::io {

/// A refusal on its way from deep inside a document to the reading function's boundary, where it
/// becomes an Error with its place in the file.
struct BadJson {
  std::string message;
  const nlohmann::json* value = nullptr;  ///< What is refused; stands in the document.
  bool at_key = false;                    ///< It is the key of the value that is wrong.
};

/// One value of a document and the way to it. All accessors throw BadJson.
class JsonReader {
 public:
  /// @param where  what messages begin with: "report.times_ms".
  JsonReader(const nlohmann::json& value, std::string where)
      : value_(&value), where_(std::move(where)) {}

  /// This is an object with exactly these keys.
  void expect_keys(std::initializer_list<const char*> keys) const {
    expect_keys(std::vector<std::string>(keys.begin(), keys.end()));
  }
  void expect_keys(const std::vector<std::string>& keys) const;
  /// This is an object with all of `required`, perhaps some of `optional`, and no other key.
  void expect_keys(const std::vector<std::string>& required,
                   const std::vector<std::string>& optional) const;
  bool has(const std::string& key) const;
  JsonReader operator[](const std::string& key) const;  ///< Member of an object.

  std::vector<JsonReader> items() const;  ///< Of an array.
  std::vector<std::string> keys() const;  ///< Of an object.

  double number() const;
  double non_negative() const;
  double positive() const;
  bool boolean() const;
  /// Whole, from 0 to `most`.
  std::uint64_t count(std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const;
  std::string text() const;
  std::string name() const;  ///< Text that is not empty.
  std::vector<double> numbers() const;
  Eigen::VectorXd vector(Eigen::Index size, const std::string& what) const;
  const std::string& where() const { return where_; }  ///< "report.times_ms"
  bool is_null() const { return value_->is_null(); }

  /// "WHERE is VALUE, expected EXPECTED".
  [[noreturn]] void refuse(const std::string& expected) const;
  /// "WHERE: MESSAGE".
  [[noreturn]] void complain(const std::string& message) const;

 private:
  const nlohmann::json* value_;
  std::string where_;
};

/// A parsed file that knows where its values stand.
class JsonDocument {
 public:
  /// @return kNotFound, kIo, or kInvalidInput with line and column; a key that stands twice in one
  /// object, more than 64 levels or 64 MiB are errors.
  static Result<JsonDocument> load(const std::filesystem::path& file);

  /// Valid while the document stays where it is.
  JsonReader root() const { return {json_, ""}; }
  /// "FILE:LINE:COLUMN: MESSAGE"
  Error error(const BadJson& bad) const;

 private:
  JsonDocument() = default;

  std::string file_, text_;
  nlohmann::json json_;
};

/// Reads a file with `read(const JsonReader& root)`.
template <class Read>
auto read_json(const std::filesystem::path& file, Read read)
    -> Result<decltype(read(std::declval<const JsonReader&>()))> {
  const Result<JsonDocument> document = JsonDocument::load(file);
  if (!document) return std::unexpected(document.error());
  try {
    return read(document->root());
  } catch (const BadJson& bad) {
    return std::unexpected(document->error(bad));
  }
}

}  // namespace tandem::io
