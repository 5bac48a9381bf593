#include "tandem/shortening/soft_qp.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"

namespace tandem::shortening {

using Eigen::ArrayXd, Eigen::Index, Eigen::VectorXd;

Index SoftQp::constraint_count() const {
  Index count = 0;
  for (const Group& group : groups) count += group.count();
  return count;
}

void SoftQp::lacking(const VectorXd& x, ArrayXd& out) const {
  const Index size = H.block_size();
  out.resize(constraint_count());
  Index k = 0;
  for (const Group& group : groups) {
    auto part = out.segment(k, group.count()).matrix();
    part = group.bounds;
    const Index first = group.block * size;
    if (group.at_block.size() > 0) {
      part.noalias() -= group.at_block.transpose() * x.segment(first, size);
    }
    if (group.at_next.size() > 0) {
      part.noalias() -= group.at_next.transpose() * x.segment(first + size, size);
    }
    k += group.count();
  }
}

double SoftQp::value(const VectorXd& x, double free) const {
  VectorXd Hx(x.size());
  H.multiply(x, Hx);
  ArrayXd missing;
  lacking(x, missing);
  return x.dot(0.5 * Hx + g) + penalty * (missing - free).max(0.0).sum();
}

namespace {

constexpr double kLeastSlack = 1e-3;    // Of the start: nothing begins at its boundary.
constexpr double kToBoundary = 0.995;   // Fraction of the way to the nearest boundary.
constexpr double kNothingLeft = 1e-13;  // Objectives are scaled to about 1.
constexpr int kMostIterations = 40;

/// Every constraint as a^T x + s - t = b with s, t >= 0: t its slack and multiplier lambda, s its
/// violation and multiplier nu = penalty - lambda, kept apart since the difference loses its
/// digits. Bounds have multipliers z.
struct Point {
  VectorXd x;
  ArrayXd s, t, lambda, nu;
  ArrayXd z_lower, z_upper;
};

class InteriorPoint {
 public:
  InteriorPoint(const SoftQp& qp, double tolerance)
      : qp_(qp), tolerance_(tolerance), factors_(qp.H), size_(qp.H.block_size()) {}

  QpSolution run();

 private:
  void start();
  void measure();
  bool factorise();
  /// Direction that makes every product of a slack and its multiplier `target` less the second
  /// order terms of `step_`, where `corrected`.
  void solve_direction(double target, bool corrected);
  double longest_step() const;
  void advance(double length);
  /// Sum of all products of slacks and multipliers.
  double gap(const Point& p) const;
  ArrayXd from_lower(const Point& p) const { return p.x.array() - qp_.lower.array(); }
  ArrayXd from_upper(const Point& p) const { return qp_.upper.array() - p.x.array(); }
  VectorXd gathered(const ArrayXd& per_constraint) const;

  const SoftQp& qp_;
  double tolerance_;
  math::BlockTridiagonal factors_;
  Index size_;
  Point at_, step_;
  ArrayXd bounds_;  // What lacks at x = 0.
  VectorXd dual_;   // H x + g - A^T lambda - z_lower + z_upper.
  ArrayXd primal_;  // b - A x - s + t.
  ArrayXd sigma_;   // Weight of every constraint in the reduced system.
  Eigen::MatrixXd here_, next_;
};

/// A^T y.
VectorXd InteriorPoint::gathered(const ArrayXd& y) const {
  VectorXd sum = VectorXd::Zero(qp_.g.size());
  Index k = 0;
  for (const SoftQp::Group& group : qp_.groups) {
    const auto part = y.segment(k, group.count()).matrix();
    const Index first = group.block * size_;
    if (group.at_block.size() > 0) sum.segment(first, size_).noalias() += group.at_block * part;
    if (group.at_next.size() > 0) {
      sum.segment(first + size_, size_).noalias() += group.at_next * part;
    }
    k += group.count();
  }
  return sum;
}

void InteriorPoint::start() {
  at_.x = VectorXd::Zero(qp_.g.size());
  qp_.lacking(at_.x, bounds_);
  const ArrayXd& lacking = bounds_;
  const Index count = lacking.size();
  // The multipliers' scale is that of the objective's slope over the box.
  const double scale =
      std::max((qp_.g.array().abs() * (qp_.upper - qp_.lower).array()).sum(), 1e-12);
  const double mu = scale / static_cast<double>(2 * qp_.g.size() + 2 * count);
  const double slack = kLeastSlack * std::max(1.0, count > 0 ? lacking.abs().maxCoeff() : 0.0);
  at_.t = (-lacking).max(0.0) + slack;
  at_.s = lacking.max(0.0) + slack;
  at_.lambda = (mu / at_.t).min(0.5 * qp_.penalty);
  at_.nu = qp_.penalty - at_.lambda;
  at_.z_lower = mu / from_lower(at_);
  at_.z_upper = mu / from_upper(at_);
  step_ = at_;
}

void InteriorPoint::measure() {
  dual_.resize(at_.x.size());
  qp_.H.multiply(at_.x, dual_);
  dual_ += qp_.g - gathered(at_.lambda);
  dual_.array() += at_.z_upper - at_.z_lower;
  qp_.lacking(at_.x, primal_);
  primal_ += at_.t - at_.s;
}

bool InteriorPoint::factorise() {
  factors_ = qp_.H;
  sigma_ = (at_.s / at_.nu + at_.t / at_.lambda).inverse();
  const ArrayXd roots = sigma_.sqrt();
  Index k = 0;
  for (const SoftQp::Group& group : qp_.groups) {
    const auto root = roots.segment(k, group.count()).matrix().asDiagonal();
    if (group.at_block.size() > 0) here_.noalias() = group.at_block * root;
    if (group.at_next.size() > 0) next_.noalias() = group.at_next * root;
    if (group.at_block.size() > 0) {
      factors_.diagonal(group.block).selfadjointView<Eigen::Lower>().rankUpdate(here_);
    }
    if (group.at_next.size() > 0) {
      factors_.diagonal(group.block + 1).selfadjointView<Eigen::Lower>().rankUpdate(next_);
    }
    if (group.at_block.size() > 0 && group.at_next.size() > 0) {
      factors_.lower(group.block).noalias() += next_ * here_.transpose();
    }
    k += group.count();
  }
  const ArrayXd diagonal = at_.z_lower / from_lower(at_) + at_.z_upper / from_upper(at_);
  for (int b = 0; b < factors_.block_count(); ++b) {
    factors_.diagonal(b).diagonal() += diagonal.segment(b * size_, size_).matrix();
  }
  return factors_.factorise();
}

void InteriorPoint::solve_direction(double target, bool corrected) {
  const ArrayXd lower = from_lower(at_), upper = from_upper(at_);
  const auto aim = [&](const ArrayXd& a, const ArrayXd& b, double sign) -> ArrayXd {
    return corrected ? ArrayXd(target - sign * a * b) : ArrayXd::Constant(a.size(), target);
  };
  const ArrayXd dx = step_.x.array();
  const ArrayXd aim_t = aim(step_.t, step_.lambda, 1), aim_s = aim(step_.s, step_.lambda, -1);
  const ArrayXd aim_lower = aim(dx, step_.z_lower, 1), aim_upper = aim(dx, step_.z_upper, -1);

  const ArrayXd c = primal_ - aim_s / at_.nu + at_.s + aim_t / at_.lambda - at_.t;
  step_.x = gathered(sigma_ * c) - dual_;
  step_.x.array() += aim_lower / lower - at_.z_lower - aim_upper / upper + at_.z_upper;
  factors_.solve_in_place(step_.x);
  ArrayXd change;
  qp_.lacking(step_.x, change);
  step_.lambda = sigma_ * (c + change - bounds_);
  step_.t = (aim_t - at_.t * step_.lambda) / at_.lambda - at_.t;
  step_.s = (aim_s + at_.s * step_.lambda) / at_.nu - at_.s;
  step_.z_lower = (aim_lower - at_.z_lower * step_.x.array()) / lower - at_.z_lower;
  step_.z_upper = (aim_upper + at_.z_upper * step_.x.array()) / upper - at_.z_upper;
}

/// Of `step_`, until the first slack or multiplier vanishes; at most 1.
double InteriorPoint::longest_step() const {
  double length = 1;
  const auto limit = [&](const ArrayXd& value, const ArrayXd& change) {
    for (Index i = 0; i < value.size(); ++i) {
      if (value[i] + length * change[i] < 0) length = -value[i] / change[i];
    }
  };
  limit(at_.s, step_.s);
  limit(at_.t, step_.t);
  limit(at_.lambda, step_.lambda);
  limit(at_.nu, -step_.lambda);
  limit(from_lower(at_), step_.x.array());
  limit(from_upper(at_), -step_.x.array());
  limit(at_.z_lower, step_.z_lower);
  limit(at_.z_upper, step_.z_upper);
  return length;
}

void InteriorPoint::advance(double length) {
  at_.x += length * step_.x;
  at_.s += length * step_.s;
  at_.t += length * step_.t;
  at_.lambda += length * step_.lambda;
  at_.nu -= length * step_.lambda;
  at_.z_lower += length * step_.z_lower;
  at_.z_upper += length * step_.z_upper;
}

double InteriorPoint::gap(const Point& p) const {
  return (p.t * p.lambda + p.s * p.nu).sum() +
         (from_lower(p) * p.z_lower + from_upper(p) * p.z_upper).sum();
}

QpSolution InteriorPoint::run() {
  start();
  const double at_start = qp_.value(at_.x);
  const VectorXd widths = qp_.upper - qp_.lower;
  const auto products = static_cast<double>(2 * at_.x.size() + 2 * at_.s.size());
  QpSolution solution;
  for (; solution.iterations < kMostIterations; ++solution.iterations) {
    measure();
    const double now = gap(at_);
    solution.value = qp_.value(at_.x);
    // The products bound what is left only where the point solves its equations.
    const double residual = dual_.array().abs().matrix().dot(widths);
    const double fallen = std::max(at_start - solution.value, 0.0);
    if (now + residual <= tolerance_ * fallen || now + residual <= kNothingLeft) {
      solution.converged = true;
      break;
    }
    if (!factorise()) break;
    solve_direction(0, false);
    const double reach = longest_step();
    const Point here = at_;
    advance(reach);
    const double foreseen = gap(at_);
    at_ = here;
    const double centering = std::pow(foreseen / now, 3);
    solve_direction(centering * now / products, true);
    advance(kToBoundary * longest_step());
  }
  solution.x = at_.x;
  return solution;
}

}  // namespace

QpSolution solve(const SoftQp& qp, double tolerance) {
  const Index size = qp.g.size();
  expects(size == Index{qp.H.block_size()} * qp.H.block_count() && qp.lower.size() == size &&
              qp.upper.size() == size,
          "one entry per row of H");
  expects((qp.lower.array() < 0).all() && (qp.upper.array() > 0).all(),
          "0 lies strictly between the bounds");
  expects(qp.penalty > 0 && tolerance > 0, "penalty and tolerance are positive");
  return InteriorPoint(qp, tolerance).run();
}

}  // namespace tandem::shortening
