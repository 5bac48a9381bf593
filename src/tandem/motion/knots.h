#pragma once
/// What piecewise polynomials share. Internal to motion/.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::motion {

/// @return kInvalidInput naming the knot unless there are at least two, one more than segments,
/// from 0 on, finite and strictly increasing.
inline Result<void> check_knots(const std::vector<double>& knots, std::size_t segments) {
  const auto invalid = [](const std::string& what) { return fail(ErrorCode::kInvalidInput, what); };
  if (knots.size() < 2) {
    return invalid("needs at least 2 knots, has " + std::to_string(knots.size()));
  }
  if (segments + 1 != knots.size()) {
    return invalid(std::to_string(knots.size()) + " knots need " +
                   std::to_string(knots.size() - 1) + " segments, there are " +
                   std::to_string(segments));
  }
  if (knots[0] != 0) return invalid("knot 0 must be 0, is " + std::to_string(knots[0]));
  for (std::size_t k = 1; k < knots.size(); ++k) {
    if (!std::isfinite(knots[k]) || !(knots[k] > knots[k - 1])) {
      return invalid("knot " + std::to_string(k) + " (" + std::to_string(knots[k]) +
                     ") must be finite and greater than the one before it (" +
                     std::to_string(knots[k - 1]) + ")");
    }
  }
  return {};
}

/// Index of the segment that holds t, clamped.
inline int segment_at(const std::vector<double>& knots, double t) {
  const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, t);
  return static_cast<int>(after - knots.begin()) - 1;
}

}  // namespace tandem::motion
