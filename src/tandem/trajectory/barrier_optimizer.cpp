#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/trajectory/timing_problem.h"

namespace tandem::trajectory {

using Eigen::ArrayXd, Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

/// Newton's method on sum h / (mu T) - sum log(1 - ratio^2) - sum log(1 - (shortest / h)^2) over
/// u = log h, for falling mu, with T the total of the start.
///
/// Ratios are nearly powers of the intervals, so they are taken as log-linear in u: the Hessian of
/// a barrier term is then 4 / (1 - ratio^2)^2 times the square of the ratio's gradient, which needs
/// no second derivatives and is never indefinite.
class Barrier {
 public:
  /// @param start  intervals that just obey all limits.
  Barrier(TimingProblem& problem, const VectorXd& start)
      : problem_(problem), best_(start), best_total_(start.sum()), reference_(best_total_) {
    constexpr double kInside = 1.02;  // Enough to start away from the barrier's pole.
    u_ = (kInside * start.array()).log();
  }

  void minimise(const StopCondition& stop) {
    // Rough centring suffices while mu falls; only the last one decides the result.
    struct Stage {
      double mu, tolerance;
    };
    constexpr Stage kStages[] = {{1e-2, 1.0}, {1e-3, 1.0}, {1e-4, 1.0}, {1e-5, 0.1}};
    constexpr int kSteps = 20;
    for (const Stage& stage : kStages) {
      mu_ = stage.mu;
      value_ = objective();
      for (int step = 0; step < kSteps && !stop(); ++step) {
        ++iterations_;
        if (!newton_step(stage.tolerance)) break;
      }
    }
  }

  const VectorXd& best() const { return best_; }
  int iterations() const { return iterations_; }

 private:
  /// At u_; infinite outside the limits. Every point met may be scaled onto the limits, and the
  /// best of those is the result.
  double objective() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    h_ = u_.array().exp();
    if (!h_.allFinite() || !problem_.evaluate(h_)) return kInfinity;
    const double scale = problem_.scale(), total = h_.sum();
    if (total * scale < best_total_) {
      best_total_ = total * scale;
      best_ = h_ * scale;
    }
    if (!(scale < 1)) return kInfinity;
    slack_ = 1 - problem_.ratios().array().square();
    bound_ = (problem_.shortest_interval() / h_.array()).square();
    return total / (mu_ * reference_) - slack_.log().sum() - (1 - bound_).log().sum();
  }

  /// One damped step from the point of the last objective(); false where nothing is left to gain.
  bool newton_step(double tolerance) {
    problem_.differentiate();
    const MatrixXd& J = problem_.jacobian();
    const ArrayXd pull = h_.array() / (mu_ * reference_);
    VectorXd gradient = 2 * J.transpose() * (problem_.ratios().array() / slack_).matrix();
    gradient.array() += pull - 2 * bound_ / (1 - bound_);
    add_squares(J);
    H_.diagonal().array() += pull + 4 * bound_ / (1 - bound_).square();
    const VectorXd step = -H_.selfadjointView<Eigen::Lower>().llt().solve(gradient);
    const double slope = gradient.dot(step);
    if (!(slope < -tolerance)) return false;

    constexpr double kLongest = 1.0;  // [-] of any log h: beyond, the model means nothing.
    constexpr int kHalvings = 20;
    const VectorXd from = u_;
    double alpha = std::min(1.0, kLongest / step.cwiseAbs().maxCoeff());
    for (int i = 0; i < kHalvings; ++i, alpha *= 0.5) {
      u_ = from + alpha * step;
      if (const double value = objective(); value < value_ + 0.01 * alpha * slope) {
        value_ = value;
        return true;
      }
    }
    u_ = from;
    value_ = objective();
    return false;
  }

  /// H = J^T diag(4 / slack^2) J, lower half. A spline forgets an interval by a factor of about 4
  /// per knot, so a block of ratios needs only the intervals near it.
  void add_squares(const MatrixXd& J) {
    constexpr Index kBlock = 16, kReach = 8;
    const Index m = J.cols(), per_interval = J.rows() / m;
    H_.setZero(m, m);
    for (Index k = 0; k < m; k += kBlock) {
      const Index end = std::min(k + kBlock, m), first = std::max<Index>(k - kReach, 0);
      const Index width = std::min(end + kReach, m) - first;
      const Index row = k * per_interval, rows = (end - k) * per_interval;
      weighted_ =
          (2 / slack_.segment(row, rows)).matrix().asDiagonal() * J.block(row, first, rows, width);
      H_.block(first, first, width, width)
          .selfadjointView<Eigen::Lower>()
          .rankUpdate(weighted_.transpose());
    }
  }

  TimingProblem& problem_;
  VectorXd u_, h_, best_;
  ArrayXd slack_, bound_;
  MatrixXd weighted_, H_;
  double best_total_, reference_;
  double mu_ = 0, value_ = 0;
  int iterations_ = 0;
};

class BarrierOptimizer final : public TimeOptimizer {
 public:
  Timing optimize(const motion::JointPath& waypoints, const std::vector<robot::JointLimits>& limits,
                  const TimingOptions& options, const StopCondition& stop) const override {
    TimingProblem problem(waypoints, limits, options);
    Barrier barrier(problem, problem.stretched_intervals());
    barrier.minimise(stop);
    return problem.finish(barrier.best(), barrier.iterations());
  }
};

}  // namespace

std::unique_ptr<TimeOptimizer> make_barrier_optimizer() {
  return std::make_unique<BarrierOptimizer>();
}

}  // namespace tandem::trajectory
