#include "tandem/io/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tandem::io {

std::string Table::text() const {
  std::vector<std::size_t> widths;
  for (const auto& cells : rows_) {
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], cells[i].size());
    }
  }
  std::string lines;
  for (const auto& cells : rows_) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string space(widths[i] - cells[i].size(), ' ');
      line += i == 0 ? cells[i] + space : "  " + space + cells[i];
    }
    lines += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  return lines;
}

std::string Table::number(double value, int decimals) {
  constexpr double kFixed = 1e9;  // Beyond, fixed notation is only digits.
  char text[64];
  std::snprintf(text, sizeof(text), std::abs(value) < kFixed ? "%.*f" : "%.*g", decimals, value);
  return text;
}

}  // namespace tandem::io
