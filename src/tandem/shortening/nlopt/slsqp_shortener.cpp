#include "tandem/shortening/nlopt/slsqp_shortener.h"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <stdexcept>

#include "tandem/core/contract.h"
#include "tandem/math/tridiagonal.h"
#include "tandem/shortening/input.h"
#include "tandem/shortening/path_cost.h"
#include "tandem/shortening/probes.h"

namespace tandem::shortening {

using Eigen::Index, Eigen::VectorXd;
using math::RowMatrix;
using motion::JointPath;

namespace {

constexpr double kConstraintTolerance = 1e-6;  // Of scaled constraints.

/// The problem as NLopt asks for it: x stacks the inner waypoints.
class Problem {
 public:
  Problem(const collision::SsvChecker& checker, const world::PairSelection& selection,
          const JointPath& path, const ShorteningOptions& options, std::vector<Probe> probes,
          const StopCondition& stop)
      : checker_(checker),
        cell_(checker.cell()),
        selection_(selection),
        options_(options),
        scratch_(checker.make_scratch()),
        stop_(stop),
        cost_(cell_, options.weights),
        path_(path),
        placed_(path.size()),
        probes_(std::move(probes)),
        length_limit_(longest_edge(path)) {
    scale_ = objective(nullptr);
  }

  Index dimension() const { return cell_.dof() * static_cast<Index>(path_.size() - 2); }
  /// Inner waypoints, then, if edges are limited, edges.
  Index constraint_count() const {
    const auto inner = static_cast<Index>(path_.size() - 2);
    return std::isfinite(length_limit_) ? 2 * inner + 1 : inner;
  }
  double first_objective() const { return scale_; }
  long evaluations() const { return evaluations_; }
  int iterations() const { return iterations_; }
  bool stopped() const { return stopped_; }

  void set(const Eigen::Ref<const VectorXd>& x) {
    for (std::size_t i = 1; i + 1 < path_.size(); ++i) {
      path_[i] = x.segment(static_cast<Index>(i - 1) * cell_.dof(), cell_.dof());
    }
  }
  const JointPath& path() const { return path_; }

  /// The unscaled objective of the path as set.
  double objective(VectorXd* gradient);
  /// Scaled constraints, <= 0 where they hold.
  VectorXd constraints(RowMatrix* jacobian);
  /// What clearance lacks most [m].
  double violation();

  static double nlopt_objective(unsigned n, const double* x, double* gradient, void* self);
  static void nlopt_constraints(unsigned m, double* result, unsigned n, const double* x,
                                double* gradient, void* self);

 private:
  double longest_edge(const JointPath& path);
  void place(bool jacobians);
  void clearance_row(std::size_t waypoint, Index row, VectorXd& values, RowMatrix* jacobian);
  void edge_row(std::size_t edge, Index row, VectorXd& values, RowMatrix* jacobian);
  void check_stop() {
    if (!stop_()) return;
    stopped_ = true;
    throw nlopt::forced_stop();
  }

  const collision::SsvChecker& checker_;
  const world::Workcell& cell_;
  const world::PairSelection& selection_;
  const ShorteningOptions& options_;
  std::unique_ptr<collision::CollisionChecker::Scratch> scratch_;
  const StopCondition& stop_;
  PathCost cost_;
  JointPath path_;
  std::vector<Waypoint> placed_;
  std::vector<Probe> probes_;  ///< The inner waypoints.
  double length_limit_;        ///< Squared; infinity: none.
  double scale_ = 1;
  VectorXd positions_;
  robot::LinkPoses X_WL_;
  long evaluations_ = 0;
  int iterations_ = 0;
  bool stopped_ = false;
};

double Problem::longest_edge(const JointPath& path) {
  if (!std::isfinite(options_.longest_edge)) return options_.longest_edge;
  path_ = path;
  place(false);
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += std::sqrt(cost_.squared_length(placed_[i - 1], placed_[i]));
  }
  if (length == 0) return std::numeric_limits<double>::infinity();
  return std::pow(options_.longest_edge * length / static_cast<double>(path.size() - 1), 2);
}

void Problem::place(bool jacobians) {
  for (std::size_t i = 0; i < path_.size(); ++i) cost_.place(path_[i], jacobians, placed_[i]);
}

double Problem::objective(VectorXd* gradient) {
  const bool analytic = gradient && options_.difference_step == 0;
  place(analytic);
  double sum = 0;
  if (gradient) gradient->setZero(dimension());
  for (std::size_t i = 1; i < path_.size(); ++i) {
    sum += cost_.edge(placed_[i - 1], placed_[i]);
    if (analytic) {
      cost_.add_derivatives(placed_[i - 1], placed_[i], 1.0, static_cast<int>(i) - 2, *gradient,
                            nullptr);
    }
  }
  if (!gradient || analytic) return sum;
  const double step = options_.difference_step;
  for (Index k = 0; k < dimension(); ++k) {
    double& value = path_[static_cast<std::size_t>(k / cell_.dof()) + 1][k % cell_.dof()];
    const double kept = value;
    value += step;
    (*gradient)[k] = (objective(nullptr) - sum) / step;
    value = kept;
  }
  return sum;
}

void Problem::clearance_row(std::size_t waypoint, Index row, VectorXd& values,
                            RowMatrix* jacobian) {
  const auto distance = [&] {
    ++evaluations_;
    return checker_.least_clearance(path_[waypoint], selection_, *scratch_);
  };
  const collision::PairClearance nearest = distance();
  if (nearest.pair < 0) {
    values[row] = -1;
    return;
  }
  values[row] = (probes_[waypoint - 1].required - nearest.distance) / options_.clearance;
  if (!jacobian) return;
  const Index first = static_cast<Index>(waypoint - 1) * cell_.dof();
  if (options_.difference_step == 0) {
    VectorXd gradient(cell_.dof());
    cell_.forward_kinematics(path_[waypoint], positions_, X_WL_);
    collision::distance_gradient(cell_, X_WL_, nearest, gradient);
    jacobian->row(row).segment(first, cell_.dof()) = -gradient.transpose() / options_.clearance;
    return;
  }
  for (Index j = 0; j < cell_.dof(); ++j) {
    const double kept = path_[waypoint][j];
    path_[waypoint][j] += options_.difference_step;
    (*jacobian)(row, first + j) =
        -(distance().distance - nearest.distance) / (options_.difference_step * options_.clearance);
    path_[waypoint][j] = kept;
  }
}

void Problem::edge_row(std::size_t edge, Index row, VectorXd& values, RowMatrix* jacobian) {
  const Waypoint &from = placed_[edge], &to = placed_[edge + 1];
  values[row] = cost_.squared_length(from, to) / length_limit_ - 1;
  if (!jacobian) return;
  VectorXd at_from, at_to;
  cost_.length_gradient(from, to, at_from, at_to);
  const Index dof = cell_.dof(), first = static_cast<Index>(edge) * dof;
  if (edge > 0) {
    jacobian->row(row).segment(first - dof, dof) = at_from.transpose() / length_limit_;
  }
  if (edge + 2 < path_.size()) {
    jacobian->row(row).segment(first, dof) = at_to.transpose() / length_limit_;
  }
}

VectorXd Problem::constraints(RowMatrix* jacobian) {
  VectorXd values(constraint_count());
  if (jacobian) jacobian->setZero(constraint_count(), dimension());
  const std::size_t inner = path_.size() - 2;
  for (std::size_t i = 1; i <= inner; ++i) {
    clearance_row(i, static_cast<Index>(i) - 1, values, jacobian);
  }
  if (std::isfinite(length_limit_)) {
    place(jacobian != nullptr);
    for (std::size_t e = 0; e <= inner; ++e) {
      edge_row(e, static_cast<Index>(inner + e), values, jacobian);
    }
  }
  return values;
}

double Problem::violation() {
  const VectorXd values = constraints(nullptr);
  const auto inner = static_cast<Index>(path_.size() - 2);
  return std::max(0.0, values.head(inner).maxCoeff() * options_.clearance);
}

double Problem::nlopt_objective(unsigned n, const double* x, double* gradient, void* self) {
  auto& problem = *static_cast<Problem*>(self);
  problem.check_stop();
  problem.set(Eigen::Map<const VectorXd>(x, n));
  VectorXd derivative;
  const double scale = problem.scale_ > 0 ? 1 / problem.scale_ : 1.0;
  const double value = scale * problem.objective(gradient ? &derivative : nullptr);
  if (gradient) {
    ++problem.iterations_;
    Eigen::Map<VectorXd>(gradient, n) = scale * derivative;
  }
  return value;
}

void Problem::nlopt_constraints(unsigned m, double* result, unsigned n, const double* x,
                                double* gradient, void* self) {
  auto& problem = *static_cast<Problem*>(self);
  problem.check_stop();
  problem.set(Eigen::Map<const VectorXd>(x, n));
  RowMatrix jacobian;
  Eigen::Map<VectorXd>(result, m) = problem.constraints(gradient ? &jacobian : nullptr);
  if (gradient) Eigen::Map<RowMatrix>(gradient, m, n) = jacobian;
}

class SlsqpShortener final : public Shortener {
 public:
  Shortening shorten(const collision::CompiledCell& compiled, const world::PairScope& scope,
                     const JointPath& path, const ShorteningOptions& options,
                     const StopCondition& stop) const override {
    const world::Workcell& cell = compiled.cell();
    check_input(cell, path, options);
    expects(options.points_per_edge.empty() && !options.prove_edges && options.edges == 0,
            "SLSQP looks at waypoints only, and moves all");
    if (path.size() == 2) return unchanged(cell, path, options);
    std::vector<Probe> probes = make_probes(path, std::vector<int>(path.size() - 1, 0));
    const auto scratch = compiled.batch().make_scratch();
    require(compiled.batch(), *pairs_within(compiled, scope, options.clearance), path,
            options.clearance, *scratch, probes);
    Problem problem(compiled.exact(), compiled.selection(scope), path, options, std::move(probes),
                    stop);
    nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(problem.dimension()));
    solver.set_min_objective(&Problem::nlopt_objective, &problem);
    solver.add_inequality_mconstraint(
        &Problem::nlopt_constraints, &problem,
        std::vector<double>(static_cast<std::size_t>(problem.constraint_count()),
                            kConstraintTolerance));
    solver.set_ftol_rel(options.tolerance);
    if (options.joint_limits) limit_joints(cell, path, solver);
    return solve(problem, solver);
  }

 private:
  static void limit_joints(const world::Workcell& cell, const JointPath& path, nlopt::opt& solver) {
    std::vector<double> lower, upper;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      for (Index j = 0; j < cell.dof(); ++j) {
        lower.push_back(std::min(cell.lower()[j], path[i][j]));
        upper.push_back(std::max(cell.upper()[j], path[i][j]));
      }
    }
    solver.set_lower_bounds(lower);
    solver.set_upper_bounds(upper);
  }

  static Shortening solve(Problem& problem, nlopt::opt& solver) {
    Shortening result;
    result.before = problem.first_objective();
    std::vector<double> x;
    const JointPath& path = problem.path();
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      x.insert(x.end(), path[i].begin(), path[i].end());
    }
    double value = 0;
    try {
      solver.optimize(x, value);
    } catch (const nlopt::roundoff_limited&) {
      // As far as it comes: x holds its best point.
    } catch (const nlopt::forced_stop&) {
      // Stopped: likewise.
    } catch (const std::runtime_error&) {
      // SLSQP's "failure" when its line search finds nothing better: likewise.
    }
    problem.set(Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size())));
    result.path = problem.path();
    result.after = problem.objective(nullptr);
    result.violation = problem.violation();
    result.iterations = problem.iterations();
    result.evaluations = problem.evaluations();
    result.stopped = problem.stopped();
    return result;
  }
};

}  // namespace

std::unique_ptr<Shortener> make_slsqp_shortener() { return std::make_unique<SlsqpShortener>(); }

}  // namespace tandem::shortening
