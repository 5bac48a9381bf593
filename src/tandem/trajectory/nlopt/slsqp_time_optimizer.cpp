#include "tandem/trajectory/nlopt/slsqp_time_optimizer.h"

#include <cmath>
#include <nlopt.hpp>
#include <span>
#include <stdexcept>

#include "tandem/trajectory/timing_problem.h"

namespace tandem::trajectory {

using Eigen::Index, Eigen::VectorXd;

namespace {

/// The timing problem in u = log h as NLopt asks for it, and the best intervals met on the way.
class Evaluations {
 public:
  Evaluations(TimingProblem& problem, const StopCondition& stop, VectorXd start)
      : problem_(problem),
        stop_(stop),
        best_(std::move(start)),
        total_(best_.sum()),
        reference_(total_) {}

  const VectorXd& best() const { return best_; }
  int count() const { return count_; }

  static double objective(unsigned n, const double* u, double* gradient, void* self) {
    auto& e = *static_cast<Evaluations*>(self);
    const Eigen::ArrayXd h = Eigen::Map<const Eigen::ArrayXd>(u, n).exp();
    if (gradient) Eigen::Map<Eigen::ArrayXd>(gradient, n) = h / e.reference_;
    return h.sum() / e.reference_;
  }

  static void constraints(unsigned m, double* result, unsigned n, const double* u, double* gradient,
                          void* self) {
    static_cast<Evaluations*>(self)->evaluate(Eigen::Map<const VectorXd>(u, n), {result, m},
                                              gradient);
  }

 private:
  void evaluate(const VectorXd& u, std::span<double> result, double* gradient) {
    if (stop_()) throw nlopt::forced_stop();
    const VectorXd h = u.array().exp();
    ++count_;
    if (!h.allFinite() || !problem_.evaluate(h)) throw nlopt::roundoff_limited();
    const double scale = problem_.scale();
    if (h.sum() * scale < total_) {
      total_ = h.sum() * scale;
      best_ = h * scale;
    }
    const VectorXd& ratios = problem_.ratios();
    const auto m = static_cast<Index>(result.size());
    Eigen::Map<VectorXd>(result.data(), m) = ratios.cwiseAbs().array() - 1;
    if (!gradient) return;
    problem_.differentiate();
    // NLopt's gradients are row-major; |g| has the sign of g where it matters, away from zero.
    Eigen::Map<math::RowMatrix>(gradient, m, u.size()) =
        ratios.cwiseSign().asDiagonal() * problem_.jacobian();
  }

  TimingProblem& problem_;
  const StopCondition& stop_;
  VectorXd best_;
  double total_, reference_;
  int count_ = 0;
};

class SlsqpTimeOptimizer final : public TimeOptimizer {
 public:
  Timing optimize(const motion::JointPath& waypoints, const std::vector<robot::JointLimits>& limits,
                  const TimingOptions& options, const StopCondition& stop) const override {
    TimingProblem problem(waypoints, limits, options);
    const VectorXd start = problem.stretched_intervals();
    Evaluations evaluations(problem, stop, start);
    nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(start.size()));
    solver.set_min_objective(&Evaluations::objective, &evaluations);
    solver.add_inequality_mconstraint(
        &Evaluations::constraints, &evaluations,
        std::vector<double>(static_cast<std::size_t>(problem.ratios().size()), 1e-8));
    const double lowest = std::log(problem.shortest_interval());
    solver.set_lower_bounds(lowest);
    solver.set_ftol_rel(1e-3);
    solver.set_maxeval(200);
    std::vector<double> u(static_cast<std::size_t>(start.size()));
    // NLopt refuses a start that rounding put below its bound.
    VectorXd::Map(u.data(), start.size()) = start.array().log().max(lowest);
    double total = 0;
    try {
      solver.optimize(u, total);
    } catch (const std::runtime_error&) {
      // Stopped, or out of progress: however it ends, the best intervals met so far stand.
    }
    return problem.finish(evaluations.best(), evaluations.count());
  }
};

}  // namespace

std::unique_ptr<TimeOptimizer> make_slsqp_time_optimizer() {
  return std::make_unique<SlsqpTimeOptimizer>();
}

}  // namespace tandem::trajectory
