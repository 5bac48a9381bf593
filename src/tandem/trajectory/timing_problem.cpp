#include "tandem/trajectory/timing_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tandem/core/contract.h"
#include "tandem/trajectory/spline.h"

namespace tandem::trajectory {

using Eigen::Index, Eigen::RowVectorXd, Eigen::VectorXd;
using math::RowMatrix;

namespace {

/// Joints that move at all: the others cost time and constrain nothing.
std::vector<Index> moving_joints(const motion::JointPath& waypoints) {
  const RowMatrix all = stacked(waypoints);
  for (Index i = 1; i < all.rows(); ++i) {
    expects(all.row(i) != all.row(i - 1), "neighbouring waypoints must differ");
  }
  std::vector<Index> moving;
  for (Index j = 0; j < all.cols(); ++j) {
    if ((all.col(j).array() != all(0, j)).any()) moving.push_back(j);
  }
  return moving;
}

RowMatrix moving_waypoints(const motion::JointPath& waypoints) {
  return stacked(waypoints)(Eigen::all, moving_joints(waypoints));
}

}  // namespace

TimingProblem::TimingProblem(const motion::JointPath& waypoints,
                             const std::vector<robot::JointLimits>& limits,
                             const TimingOptions& options)
    : waypoints_(waypoints),
      limits_(limits),
      shortest_(options.shortest_interval),
      spline_(moving_waypoints(waypoints)) {
  expects(std::isfinite(shortest_) && shortest_ > 0, "the shortest interval must be positive");
  expects(static_cast<Index>(limits.size()) == waypoints[0].size(),
          "one limit per joint is needed");
  const std::vector<Index> moving = moving_joints(waypoints);
  const Index d = spline_.joints(), m = intervals();
  per_velocity_.resize(d);
  per_acceleration_.resize(d);
  per_jerk_.resize(d);
  bool has_jerk = false;
  for (Index j = 0; j < d; ++j) {
    const robot::JointLimits& limit =
        limits[static_cast<std::size_t>(moving[static_cast<std::size_t>(j)])];
    expects(limit.velocity > 0 && std::isfinite(limit.velocity) && limit.acceleration > 0 &&
                std::isfinite(limit.acceleration) && limit.jerk > 0,
            "timing needs positive limits, finite ones of velocity and acceleration");
    per_velocity_[j] = 1 / limit.velocity;
    per_acceleration_[j] = 1 / limit.acceleration;
    per_jerk_[j] = 1 / limit.jerk;
    has_jerk = has_jerk || std::isfinite(limit.jerk);
  }
  kinds_ = has_jerk ? 3 : 2;
  ratios_.setZero(kinds_ * m * d);
  jacobian_.setZero(kinds_ * m * d, m);
  peaks_.resize(static_cast<std::size_t>(m * d));
}

TimingProblem::Peak TimingProblem::peak_between(double p, double r) {
  // The integral of the acceleration over the fraction |p| / (|p| + |r|).
  if (p * r < 0) {
    const double x = p / (p - r), y = 1 - x;
    return {0.5 * x * p, 0.5 * x * (1 + y), 0.5 * x * x};
  }
  if (p + r == 0) return {};
  const double x = p / (p + r), y = r / (p + r);
  return {0.5 * x * (x + 3 * y) * p, 0.5 * x * (x * x + 3 * x * y + 6 * y * y),
          0.5 * x * x * (x - 3 * y)};
}

bool TimingProblem::evaluate(const VectorXd& h) {
  if (!spline_.solve(h)) return false;
  const RowMatrix &v = spline_.velocities(), &a = spline_.accelerations();
  for (Index k = 0; k < intervals(); ++k) {
    rows(ratios_, k, kAcceleration) = a.row(k).cwiseProduct(per_acceleration_);
    for (Index j = 0; j < spline_.joints(); ++j) {
      const Peak& peak = peaks_[peak_index(k, j)] = peak_between(a(k, j), a(k + 1, j));
      rows(ratios_, k, kVelocity)[j] = (v(k, j) + h[k] * peak.rise) * per_velocity_[j];
    }
    if (kinds_ > kJerk) {
      rows(ratios_, k, kJerk) = (a.row(k + 1) - a.row(k)).cwiseProduct(per_jerk_) / h[k];
    }
  }
  return ratios_.allFinite();
}

void TimingProblem::differentiate() {
  spline_.differentiate();
  const Index d = spline_.joints(), m = intervals();
  const VectorXd& h = spline_.durations();
  const RowMatrix &da = spline_.acceleration_gradients(), &dv = spline_.velocity_gradients();
  for (Index l = 0; l < m; ++l) {
    auto column = jacobian_.col(l);
    for (Index k = 0; k < m; ++k) {
      const auto da_k = da.row(k).segment(l * d, d), da_next = da.row(k + 1).segment(l * d, d);
      rows(column, k, kAcceleration) = h[l] * da_k.cwiseProduct(per_acceleration_);
      auto velocity = rows(column, k, kVelocity);
      for (Index j = 0; j < d; ++j) {
        const Peak& peak = peaks_[peak_index(k, j)];
        const double rise = peak.by_a * da_k[j] + peak.by_next * da_next[j];
        velocity[j] = h[l] * (dv(k, l * d + j) + h[k] * rise) * per_velocity_[j];
        if (l == k) velocity[j] += h[k] * peak.rise * per_velocity_[j];
      }
      if (kinds_ <= kJerk) continue;
      auto jerk = rows(column, k, kJerk);
      jerk = h[l] / h[k] * (da_next - da_k).cwiseProduct(per_jerk_);
      if (l == k) jerk -= rows(ratios_, k, kJerk);
    }
  }
}

VectorXd TimingProblem::local_scales() const {
  VectorXd scales = shortest_ * spline_.durations().cwiseInverse();
  const auto most = [&](Index k, Kind kind) {
    return rows(ratios_, k, kind).cwiseAbs().maxCoeff();
  };
  const auto note = [&](Index k, double factor) { scales[k] = std::max(scales[k], factor); };
  for (Index k = 0; k < intervals(); ++k) {
    const double acceleration = std::sqrt(most(k, kAcceleration));
    note(k, acceleration);
    if (k > 0) note(k - 1, acceleration);
    note(k, most(k, kVelocity));
    if (kinds_ > kJerk) note(k, std::cbrt(most(k, kJerk)));
  }
  return scales;
}

VectorXd TimingProblem::initial_intervals() const {
  const Index m = intervals();
  const auto edge_time = [&](Index edge) {
    const auto i = static_cast<std::size_t>(edge);
    double time = 0;
    for (std::size_t j = 0; j < limits_.size(); ++j) {
      const double way =
          std::abs(waypoints_[i + 1][static_cast<Index>(j)] - waypoints_[i][static_cast<Index>(j)]);
      if (way == 0) continue;
      time = std::max({time, way / limits_[j].velocity, std::sqrt(way / limits_[j].acceleration),
                       std::cbrt(way / limits_[j].jerk)});
    }
    return time;
  };
  // The first and the last edge hold a free knot each, an only edge both.
  VectorXd h(m);
  if (m == 3) {
    h.setConstant(edge_time(0) / 3);
  } else {
    for (Index edge = 0; edge + 1 < m - 1; ++edge) h[edge + 1] = edge_time(edge);
    h[0] = h[1] *= 0.5;
    h[m - 1] = h[m - 2] *= 0.5;
  }
  return h.cwiseMax(shortest_);
}

VectorXd TimingProblem::stretched_intervals() {
  VectorXd h = initial_intervals(), best = h;
  double shortest_total = std::numeric_limits<double>::infinity();
  constexpr int kRounds = 10;
  for (int round = 0; round <= kRounds; ++round) {
    if (!evaluate(h)) break;
    if (const double total = h.sum() * scale(); total < shortest_total) {
      shortest_total = total;
      best = h * scale();
    }
    h.array() *= local_scales().array().sqrt();
  }
  return best;
}

Timing TimingProblem::finish(VectorXd h, int iterations) const {
  // Rounding of knots and coefficients leaves the last bits to trial.
  double margin = 1e-13;
  for (bool first = true;; first = false, margin *= 4) {
    const std::vector<double> durations(h.begin(), h.end());
    const Extremes reached = extremes(fit_spline(waypoints_, durations));
    bool within = h.minCoeff() >= shortest_;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const auto j = static_cast<Index>(i);
      within = within && reached.velocity[j] <= limits_[i].velocity &&
               reached.acceleration[j] <= limits_[i].acceleration &&
               reached.jerk[j] <= limits_[i].jerk;
    }
    // The first round also takes back what was left unused.
    if (within && !first) return {durations, h.sum(), iterations};
    const double factor = std::max(stretch_factor(reached, limits_), shortest_ / h.minCoeff());
    h *= (first ? factor : std::max(factor, 1.0)) * (1 + margin);
  }
}

}  // namespace tandem::trajectory
