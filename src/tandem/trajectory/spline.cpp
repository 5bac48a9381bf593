#include "tandem/trajectory/spline.h"

#include <vector>

#include "tandem/core/contract.h"
#include "tandem/trajectory/spline_system.h"

namespace tandem::trajectory {

motion::PiecewiseCubic fit_spline(const motion::JointPath& waypoints,
                                  std::span<const double> durations) {
  using Eigen::Index, Eigen::VectorXd;
  SplineSystem system(stacked(waypoints));
  const Index m = system.intervals();
  expects(durations.size() == static_cast<std::size_t>(m), "N waypoints need N + 1 durations");
  const VectorXd h = Eigen::Map<const VectorXd>(durations.data(), m);
  expects(h.allFinite() && system.solve(h), "durations are too uneven for a spline");
  const auto &q = system.positions(), &a = system.accelerations();

  std::vector<double> knots{0};
  std::vector<motion::PiecewiseCubic::Coefficients> segments;
  for (Index k = 0; k < m; ++k) {
    knots.push_back(knots.back() + h[k]);
    motion::PiecewiseCubic::Coefficients c(system.joints(), 4);
    c.col(0) = q.row(k);
    c.col(2) = 0.5 * a.row(k);
    c.col(3) = (a.row(k + 1) - a.row(k)) / (6 * h[k]);
    if (k == 0) {
      c.col(1).setZero();  // Exactly, as promised at the ends.
    } else if (k == m - 1) {
      c.col(1) = -0.5 * h[k] * a.row(k);
    } else {
      c.col(1) = (q.row(k + 1) - q.row(k)) / h[k] - h[k] / 6 * (2 * a.row(k) + a.row(k + 1));
    }
    segments.push_back(std::move(c));
  }
  auto spline = motion::PiecewiseCubic::make(std::move(knots), std::move(segments));
  expects(spline.has_value(), "durations vanish beside their sum, or accelerations overflow");
  return *std::move(spline);
}

}  // namespace tandem::trajectory
