#pragma once
/// Random smooth motions, for tests of certificates.

#include "tandem/core/rng.h"
#include "tandem/motion/piecewise_cubic.h"

namespace tandem::test {

/// Random cubic segments, continuous in position and velocity, that wander from q by about `size`.
inline motion::PiecewiseCubic random_cubic(Rng& rng, const Eigen::VectorXd& q, double size) {
  using Eigen::VectorXd;
  using motion::PiecewiseCubic;
  const int count = 1 + static_cast<int>(rng.index(4));
  std::vector<double> knots{0};
  std::vector<PiecewiseCubic::Coefficients> segments;
  VectorXd c0 = q, c1 = VectorXd::Zero(q.size());
  const auto random_vector = [&] {
    VectorXd v(q.size());
    for (double& x : v) x = rng.uniform(-size, size);
    return v;
  };
  c1 = random_vector();
  for (int k = 0; k < count; ++k) {
    const double h = rng.uniform(0.1, 0.6);
    PiecewiseCubic::Coefficients c(q.size(), 4);
    c << c0, c1, 2 * random_vector(), 3 * random_vector();
    segments.push_back(c);
    knots.push_back(knots.back() + h);
    c0 = c.col(0) + h * (c.col(1) + h * (c.col(2) + h * c.col(3)));
    c1 = c.col(1) + h * (2 * c.col(2) + 3 * h * c.col(3));
  }
  return *PiecewiseCubic::make(knots, segments);
}

}  // namespace tandem::test
