#include "tandem/core/names.h"

#include <algorithm>
#include <numeric>

namespace tandem {

namespace {

/// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  std::size_t best = std::max<std::size_t>(2, name.size() / 3) + 1;
  std::string nearest;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string name_hint(std::string_view name, const std::vector<std::string>& known) {
  if (const std::string nearest = nearest_name(name, known); !nearest.empty()) {
    return "; did you mean '" + nearest + "'?";
  }
  if (known.empty()) return "; there are none";
  constexpr std::size_t kMost = 8;
  std::string hint = "; known: ";
  for (std::size_t i = 0; i < std::min(kMost, known.size()); ++i) {
    hint += (i ? ", " : "") + known[i];
  }
  return hint + (known.size() > kMost ? ", ..." : "");
}

}  // namespace tandem
