#pragma once
/// Aligned text tables for terminals and logs.

#include <string>
#include <vector>

namespace tandem::io {

/// Columns as wide as their widest cell; the first to the left, the others to the right.
class Table {
 public:
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// One line per row, two spaces between columns, each line ended.
  std::string text() const;

  /// Fixed notation with `decimals` digits.
  static std::string number(double value, int decimals);

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tandem::io
