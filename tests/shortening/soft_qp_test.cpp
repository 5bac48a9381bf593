#include "tandem/shortening/soft_qp.h"

#include <gtest/gtest.h>

#include <ctime>
#include <nlopt.hpp>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::shortening {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

MatrixXd random_matrix(Index rows, Index cols, Rng& rng) {
  MatrixXd m(rows, cols);
  for (double& value : m.reshaped()) value = rng.uniform(-1, 1);
  return m;
}

SoftQp random_qp(int size, int count, int groups, Rng& rng) {
  SoftQp qp(size, count);
  for (int k = 0; k < count; ++k) {
    const MatrixXd root = random_matrix(size, size, rng);
    qp.H.diagonal(k) = root * root.transpose() + 2.5 * size * MatrixXd::Identity(size, size);
    if (k + 1 < count) qp.H.lower(k) = random_matrix(size, size, rng);
  }
  qp.g = 4 * size * random_matrix(size * count, 1, rng);
  qp.lower = random_matrix(size * count, 1, rng).array() * 0.4 - 0.5;
  qp.upper = random_matrix(size * count, 1, rng).array() * 0.4 + 0.5;
  qp.penalty = rng.uniform(0.5, 20);
  for (int i = 0; i < groups; ++i) {
    const Index columns = 1 + i % 4;
    SoftQp::Group group{static_cast<int>(rng.uniform(0, count)) - (i % 3 == 2 ? 1 : 0),
                        rng.uniform(0.1, 1), i % 3 == 0 ? 0.0 : rng.uniform(0.1, 1),
                        random_matrix(size, columns, rng),
                        // Some cannot be met at all.
                        random_matrix(columns, 1, rng) * (i % 5 == 0 ? 5.0 : 0.8)};
    if (i % 4 == 1) group.at_next = random_matrix(size, columns, rng);
    qp.groups.push_back(group);
  }
  return qp;
}

/// The problem with one slack variable per constraint, as NLopt sees it.
struct SlackProblem {
  const SoftQp& qp;
  Index n, m;  ///< Variables and constraints.
};

void lacking_beyond_slack(unsigned rows, double* result, unsigned cols, const double* x,
                          double* gradient, void* raw) {
  const auto& d = *static_cast<SlackProblem*>(raw);
  Eigen::ArrayXd along;
  d.qp.project(Eigen::Map<const VectorXd>(x, d.n), along);
  Eigen::Map<VectorXd>(result, rows) =
      (d.qp.bounds() - along).matrix() - Eigen::Map<const VectorXd>(x + d.n, d.m);
  if (!gradient) return;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows> A(gradient, rows, cols);
  A.setZero();
  for (Index j = 0; j < d.n; ++j) {
    d.qp.project(VectorXd::Unit(d.n, j), along);
    A.col(j) = -along;
  }
  A.rightCols(d.m) = -MatrixXd::Identity(d.m, d.m);
}

/// Its optimum by SLSQP.
double reference(const SoftQp& qp) {
  const Index n = qp.g.size(), m = qp.constraint_count();
  SlackProblem data{qp, n, m};
  nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(n + m));
  solver.set_min_objective(
      [](unsigned, const double* x, double* gradient, void* raw) {
        const auto& d = *static_cast<SlackProblem*>(raw);
        const VectorXd at = Eigen::Map<const VectorXd>(x, d.n);
        const VectorXd slack = Eigen::Map<const VectorXd>(x + d.n, d.m);
        VectorXd Hx(d.n);
        d.qp.H.multiply(at, Hx);
        if (gradient) {
          Eigen::Map<VectorXd>(gradient, d.n) = Hx + d.qp.g;
          Eigen::Map<VectorXd>(gradient + d.n, d.m).setConstant(d.qp.penalty);
        }
        return at.dot(0.5 * Hx + d.qp.g) + d.qp.penalty * slack.sum();
      },
      &data);
  solver.add_inequality_mconstraint(&lacking_beyond_slack, &data,
                                    std::vector<double>(static_cast<std::size_t>(m), 1e-10));
  std::vector<double> lower(qp.lower.begin(), qp.lower.end());
  std::vector<double> upper(qp.upper.begin(), qp.upper.end());
  lower.resize(static_cast<std::size_t>(n + m), 0.0);
  upper.resize(static_cast<std::size_t>(n + m), HUGE_VAL);
  solver.set_lower_bounds(lower);
  solver.set_upper_bounds(upper);
  solver.set_xtol_rel(1e-10);
  solver.set_maxeval(500);
  std::vector<double> x(static_cast<std::size_t>(n), 0.0);
  for (double missing : qp.bounds()) x.push_back(std::max(0.0, missing));
  double value = 0;
  try {
    solver.optimize(x, value);
  } catch (const nlopt::roundoff_limited&) {
    // As exact as it comes.
  }
  return qp.value(Eigen::Map<const VectorXd>(x.data(), n));
}

TEST(SoftQp, FindsTheOptimumThatSlsqpFinds) {
  Rng rng(1);
  for (int n = 0; n < 120; ++n) {
    const int size = 1 + n % 7, count = 1 + n % 5;
    const SoftQp qp = random_qp(size, count, n % 11, rng);
    const QpSolution solution = solve(qp, 1e-6);
    ASSERT_TRUE(solution.converged) << "problem " << n;
    EXPECT_TRUE((solution.x.array() > qp.lower.array()).all());
    EXPECT_TRUE((solution.x.array() < qp.upper.array()).all());
    EXPECT_NEAR(solution.value, qp.value(solution.x), 1e-11 * (1 + std::abs(solution.value)));
    const double best = reference(qp);
    const double scale = 1e-6 * (1 + qp.value(VectorXd::Zero(qp.g.size())) - best);
    EXPECT_NEAR(solution.value, best, 2 * scale) << "problem " << n;
  }
}

TEST(SoftQp, ToleranceBoundsWhatIsLeft) {
  Rng rng(2);
  for (int n = 0; n < 60; ++n) {
    const SoftQp qp = random_qp(7, 6, 12, rng);
    const double best = solve(qp, 1e-9).value;
    for (const double tolerance : {1e-1, 1e-2, 3e-3}) {
      const QpSolution solution = solve(qp, tolerance);
      ASSERT_TRUE(solution.converged);
      EXPECT_LE(solution.value - best, tolerance * (qp.value(VectorXd::Zero(42)) - best) + 1e-12);
      EXPECT_LE(solution.rounds, 25);
    }
  }
}

TEST(SoftQp, WithoutConstraintsItIsALinearSolveInABox) {
  Rng rng(3);
  SoftQp qp = random_qp(5, 4, 0, rng);
  qp.g *= 0.001;  // The optimum lies inside.
  VectorXd x = -qp.g;
  math::BlockTridiagonal factors = qp.H;
  ASSERT_TRUE(factors.factorise());
  factors.solve_in_place(x);
  EXPECT_LT((solve(qp, 1e-10).x - x).norm(), 1e-4 * x.norm());
}

TEST(SoftQp, StopsInTheMiddleOfALargeProgram) {
  Rng rng(4);
  const SoftQp qp = random_qp(14, 158, 1200, rng);
  const std::clock_t begin = std::clock();
  const QpSolution solution = solve(qp, 1e-9, {}, StopCondition::after(0.02));
  // Of processor time: others may hold this program up.
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.1);
  EXPECT_FALSE(solution.converged);
  EXPECT_TRUE((solution.x.array() > qp.lower.array()).all());
  EXPECT_TRUE((solution.x.array() < qp.upper.array()).all());
}

TEST(SoftQp, RefusesAStartOutsideItsBounds) {
  Rng rng(4);
  SoftQp qp = random_qp(2, 2, 3, rng);
  qp.lower[1] = 0;
  EXPECT_THROW(solve(qp, 1e-3), ContractViolation);
}

}  // namespace
}  // namespace tandem::shortening
