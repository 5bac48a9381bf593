#pragma once
/// Random splines for tests.

#include <cmath>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/motion/piecewise_cubic.h"
#include "tandem/motion/time_map.h"

namespace tandem::motion {

inline PiecewiseCubic::Coefficients random_coefficients(Rng& rng, int dof) {
  PiecewiseCubic::Coefficients c =
      Eigen::MatrixXd::NullaryExpr(dof, 4, [&] { return rng.uniform(-2, 2); });
  // Degenerate cubics in every mix: constants, lines, parabolas, and leading terms next to nothing.
  for (int j = 0; j < dof; ++j) {
    for (int i = 0; i < 4; ++i) {
      const std::size_t kind = rng.index(6);
      if (kind == 0) c(j, i) = 0;
      if (kind == 1) c(j, i) *= 1e-14;
    }
  }
  return c;
}

/// Jumps at every knot.
inline PiecewiseCubic random_motion(Rng& rng, int count, int dof) {
  std::vector<double> knots{0};
  std::vector<PiecewiseCubic::Coefficients> segments;
  for (int k = 0; k < count; ++k) {
    knots.push_back(knots.back() + std::pow(10, rng.uniform(-3, 0.3)));
    segments.push_back(random_coefficients(rng, dof));
  }
  return *PiecewiseCubic::make(knots, segments);
}

/// Within [0, T] at its knots, anywhere between; jumps at every knot. Degrees 0 to 5, with leading
/// terms that vanish or nearly do.
inline TimeMap random_map(Rng& rng, int count, double T) {
  std::vector<double> knots{0};
  std::vector<TimeMap::Segment> segments;
  for (int k = 0; k < count; ++k) {
    const double h = std::pow(10, rng.uniform(-2, 0.5));
    knots.push_back(knots.back() + h);
    TimeMap::Segment c{};
    const std::size_t degree = rng.index(6);
    double power = 1, end = 0;
    for (std::size_t i = 1; i <= degree; ++i) {
      power *= h;
      c[i] = rng.uniform(-1, 1) * T / power * (rng.index(6) == 0 ? 1e-14 : 1);
    }
    // The slope brings c from one place in [0, T] to another.
    const double from = rng.uniform(0, T), to = rng.uniform(0, T);
    power = 1;
    for (std::size_t i = 1; i <= degree; ++i) end += c[i] * (power *= h);
    c[0] = from;
    if (degree >= 1) c[1] += (to - from - end) / h;
    segments.push_back(c);
  }
  return *TimeMap::make(std::move(knots), std::move(segments));
}

}  // namespace tandem::motion
