#pragma once
/// Strict reading of JSON: every refusal names the key, the value and what was expected.

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::io {

/// A refusal on its way from deep inside a document to the reading function's boundary, where it
/// becomes an Error.
struct BadJson {
  std::string message;
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
  JsonReader operator[](const std::string& key) const;  ///< Member of an object.

  std::vector<JsonReader> items() const;  ///< Of an array.
  std::vector<std::string> keys() const;  ///< Of an object.

  double number() const;
  double non_negative() const;
  /// Whole, from 0 to `most`.
  std::uint64_t count(std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const;
  std::string text() const;
  std::string name() const;  ///< Text that is not empty.
  std::vector<double> numbers() const;
  Eigen::VectorXd vector(Eigen::Index size, const std::string& what) const;
  bool is_null() const { return value_->is_null(); }

  /// "WHERE is VALUE, expected EXPECTED".
  [[noreturn]] void refuse(const std::string& expected) const;
  /// "WHERE: MESSAGE".
  [[noreturn]] void complain(const std::string& message) const;

 private:
  const nlohmann::json* value_;
  std::string where_;
};

/// The document in `file`.   @return kNotFound, kIo, or kInvalidInput with line and column; a key
/// that stands twice in one object is an error.
Result<nlohmann::json> parse_json_file(const std::filesystem::path& file);

}  // namespace tandem::io
