#include "tandem/trajectory/spline_system.h"

#include "tandem/core/contract.h"

namespace tandem::trajectory {

using Eigen::Index, Eigen::VectorXd;
using math::RowMatrix, math::TridiagonalLu;

namespace {

/// A(h): the C2 conditions at the inner knots. The free knots' positions depend on their own
/// accelerations, Q = q + a h^2 / 6, which puts h^2 / h_next into the outer columns.
TridiagonalLu factorise(const VectorXd& h) {
  const Index n = h.size() - 1;
  expects(n >= 2, "a spline needs at least two waypoints");
  VectorXd lower = h.segment(1, n - 1), upper = lower;
  VectorXd diagonal = 2 * (h.head(n) + h.tail(n));
  const double first = h[0] * h[0] / h[1], last = h[n] * h[n] / h[n - 1];
  diagonal[0] += h[0] + first;
  lower[0] -= first;
  diagonal[n - 1] += h[n] + last;
  upper[n - 2] -= last;
  return {lower, diagonal, upper};
}

}  // namespace

SplineSystem::SplineSystem(RowMatrix waypoints)
    : waypoints_(std::move(waypoints)),
      h_(VectorXd::Ones(waypoints_.rows() + 1)),
      factors_(factorise(h_)) {
  const Index knots = intervals() + 1;
  q_.setZero(knots, joints());
  v_.setZero(knots, joints());
  a_.setZero(knots, joints());
}

bool SplineSystem::solve(const VectorXd& h) {
  expects(h.size() == intervals() && (h.array() > 0).all(),
          "a spline of N waypoints needs N + 1 positive intervals");
  h_ = h;
  factors_ = factorise(h);
  if (!factors_.ok()) return false;
  const Index n = waypoints_.rows();  // Unknown accelerations: knots 1 .. n.

  // The right-hand side sees the free knots at their neighbours' waypoints.
  q_.row(0) = q_.row(1) = waypoints_.row(0);
  q_.middleRows(2, n - 2) = waypoints_.middleRows(1, n - 2);
  q_.row(n) = q_.row(n + 1) = waypoints_.row(n - 1);
  for (Index k = 1; k <= n; ++k) {
    a_.row(k) = 6 / h[k] * (q_.row(k + 1) - q_.row(k)) - 6 / h[k - 1] * (q_.row(k) - q_.row(k - 1));
  }
  factors_.solve_in_place(a_.middleRows(1, n));

  q_.row(1) += h[0] * h[0] / 6 * a_.row(1);
  q_.row(n) += h[n] * h[n] / 6 * a_.row(n);
  for (Index k = 1; k <= n; ++k) {
    v_.row(k) = v_.row(k - 1) + 0.5 * h[k - 1] * (a_.row(k - 1) + a_.row(k));
  }
  return true;
}

void SplineSystem::differentiate() {
  const Index n = waypoints_.rows(), m = intervals(), d = joints();
  da_.setZero(n + 2, m * d);
  const auto rhs = [&](Index knot, Index l) { return da_.row(knot).segment(l * d, d); };
  // An end interval acts through the free knot's position alone.
  rhs(1, 0) = -(3 + 2 * h_[0] / h_[1]) * a_.row(1);
  rhs(2, 0) += 2 * h_[0] / h_[1] * a_.row(1);
  rhs(n, n) = -(3 + 2 * h_[n] / h_[n - 1]) * a_.row(n);
  rhs(n - 1, n) += 2 * h_[n] / h_[n - 1] * a_.row(n);
  for (Index l = 1; l < n; ++l) {
    const double per_square = 6 / (h_[l] * h_[l]);
    rhs(l, l) = per_square * (q_.row(l) - q_.row(l + 1)) - 2 * a_.row(l) - a_.row(l + 1);
    rhs(l + 1, l) = per_square * (q_.row(l + 1) - q_.row(l)) - a_.row(l) - 2 * a_.row(l + 1);
  }
  factors_.solve_in_place(da_.middleRows(1, n));

  dv_.setZero(n + 2, m * d);
  for (Index k = 1; k <= n; ++k) {
    dv_.row(k) = dv_.row(k - 1) + 0.5 * h_[k - 1] * (da_.row(k - 1) + da_.row(k));
    dv_.row(k).segment((k - 1) * d, d) += 0.5 * (a_.row(k - 1) + a_.row(k));
  }
}

RowMatrix stacked(const motion::JointPath& waypoints) {
  expects(waypoints.size() >= 2, "a spline needs at least two waypoints");
  RowMatrix rows(static_cast<Index>(waypoints.size()), waypoints[0].size());
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    expects(waypoints[i].size() == rows.cols() && rows.cols() > 0 && waypoints[i].allFinite(),
            "waypoints must be finite and of one size");
    rows.row(static_cast<Index>(i)) = waypoints[i];
  }
  return rows;
}

}  // namespace tandem::trajectory
