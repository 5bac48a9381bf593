#include "tandem/shortening/soft_qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/core/contract.h"

namespace tandem::shortening {

using Eigen::ArrayXd, Eigen::Index, Eigen::VectorXd;

Index SoftQp::constraint_count() const {
  Index count = 0;
  for (const Group& group : groups) count += group.count();
  return count;
}

ArrayXd SoftQp::bounds() const {
  ArrayXd all(constraint_count());
  Index k = 0;
  for (const Group& group : groups) {
    all.segment(k, group.count()) = group.bounds.array();
    k += group.count();
  }
  return all;
}

void SoftQp::project(const VectorXd& x, ArrayXd& out) const {
  out.resize(constraint_count());
  const Index size = H.block_size();
  Index k = 0;
  for (const Group& group : groups) {
    auto part = out.segment(k, group.count()).matrix();
    const Index first = group.block * size;
    k += group.count();
    if (has_here(group) && has_next(group) && group.at_next.size() == 0) {
      part.noalias() = group.at.transpose() * (group.here * x.segment(first, size) +
                                               group.next * x.segment(first + size, size));
      continue;
    }
    part.setZero();
    if (has_here(group)) {
      part.noalias() += group.at.transpose() * (group.here * x.segment(first, size));
    }
    if (has_next(group)) {
      part.noalias() +=
          group.columns_next().transpose() * (group.next * x.segment(first + size, size));
    }
  }
}

double SoftQp::value(const VectorXd& x, double free) const {
  VectorXd Hx(x.size());
  H.multiply(x, Hx);
  ArrayXd along;
  project(x, along);
  return x.dot(0.5 * Hx + g) + penalty * (bounds() - along - free).max(0.0).sum();
}

namespace {

constexpr double kInside = 1e-12;       // Of the box's width: how near to its sides x may be.
constexpr double kNothingLeft = 1e-13;  // Objectives are scaled to about 1.
constexpr double kHard = std::numeric_limits<double>::infinity();
constexpr int kMostRounds = 40;
constexpr int kAtOnce = 2;  // Constraints of a group, added in one round.

/// min q(l) = l^T S l / 2 - c^T l over 0 <= l <= most, which grows by rows.
class DualProblem {
 public:
  explicit DualProblem(const StopCondition& stop) : stop_(stop) {}

  VectorXd lambda;

  Index size() const { return lambda.size(); }
  /// @param row  entries of S with the rows before, then with itself.
  void add(const VectorXd& row, double c, double most, double start);
  void solve();

 private:
  void find_free(const VectorXd& gradient);
  VectorXd direction(const VectorXd& gradient);
  VectorXd to_first_side(const VectorXd& d) const;
  double value(const VectorXd& l) const { return l.dot(0.5 * (S() * l) - c_); }
  Eigen::Ref<const Eigen::MatrixXd> S() const { return S_.topLeftCorner(size(), size()); }

  const StopCondition& stop_;
  Eigen::MatrixXd S_;
  VectorXd c_, most_;
  std::vector<Index> free_;
};

void DualProblem::add(const VectorXd& row, double c, double most, double start) {
  const Index n = size();
  if (S_.rows() == n) S_.conservativeResize(2 * n + 16, 2 * n + 16);
  S_.row(n).head(n + 1) = row.transpose();
  S_.col(n).head(n + 1) = row;
  lambda.conservativeResize(n + 1);
  c_.conservativeResize(n + 1);
  most_.conservativeResize(n + 1);
  lambda[n] = start;
  c_[n] = c;
  most_[n] = most;
}

/// What may move: not at a side that it is pushed against.
void DualProblem::find_free(const VectorXd& gradient) {
  free_.clear();
  for (Index i = 0; i < size(); ++i) {
    const bool held =
        (lambda[i] <= 0 && gradient[i] >= 0) || (lambda[i] >= most_[i] && gradient[i] <= 0);
    if (!held) free_.push_back(i);
  }
}

/// Newton's direction of those that are free; what it would push out of its range is held.
VectorXd DualProblem::direction(const VectorXd& gradient) {
  constexpr double kSingular = 1e-10;  // Constraints may depend on each other.
  VectorXd all = VectorXd::Zero(size());
  while (!free_.empty() && !stop_()) {
    Eigen::MatrixXd part = S_(free_, free_);
    part.diagonal() *= 1 + kSingular;
    const VectorXd d = part.llt().solve(-gradient(free_));
    std::vector<Index> kept;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const Index i = free_[k];
      const double towards = d[static_cast<Index>(k)];
      if ((lambda[i] <= 0 && towards < 0) || (lambda[i] >= most_[i] && towards > 0)) continue;
      kept.push_back(i);
      all[i] = towards;
    }
    if (kept.size() == free_.size()) return all;
    all.setZero();
    free_ = std::move(kept);
  }
  return all;
}

void DualProblem::solve() {
  constexpr int kMostSteps = 100;
  constexpr double kFlat = 1e-11;  // Of the gradient, against c.
  if (size() == 0) return;
  const double flat = kFlat * (1e-3 + c_.cwiseAbs().maxCoeff());
  double now = value(lambda);
  for (int i = 0; i < kMostSteps && !stop_(); ++i) {
    const VectorXd gradient = S() * lambda - c_;
    find_free(gradient);
    double steepest = 0;
    for (const Index k : free_) steepest = std::max(steepest, std::abs(gradient[k]));
    if (steepest <= flat) return;
    const VectorXd d = direction(gradient);
    VectorXd next;
    double there = now;
    for (double part = 1; part > 0.1 && !(there < now); part *= 0.5) {  // Bent at the sides.
      next = (lambda + part * d).cwiseMax(0.0).cwiseMin(most_);
      there = value(next);
    }
    if (!(there < now)) {
      next = to_first_side(d);
      there = value(next);
    }
    if (!(there <= now)) return;  // Down to rounding.
    lambda = next;
    now = there;
  }
}

/// From lambda along d, which always leads down, until the first one is at a side.
VectorXd DualProblem::to_first_side(const VectorXd& d) const {
  double reach = 1;
  Index first = -1;
  for (Index k = 0; k < size(); ++k) {
    const double side = d[k] < 0 ? 0.0 : most_[k];
    if (d[k] == 0 || (d[k] > 0 && lambda[k] + reach * d[k] <= side) ||
        (d[k] < 0 && lambda[k] + reach * d[k] >= side)) {
      continue;
    }
    reach = (side - lambda[k]) / d[k];
    first = k;
  }
  VectorXd next = (lambda + reach * d).cwiseMax(0.0).cwiseMin(most_);
  if (first >= 0) next[first] = d[first] < 0 ? 0.0 : most_[first];
  return next;
}

class ActiveSet {
 public:
  ActiveSet(const SoftQp& qp, double tolerance, const StopCondition& stop)
      : qp_(qp),
        tolerance_(tolerance),
        stop_(stop),
        size_(qp.H.block_size()),
        bounds_(qp.bounds()),
        factors_(qp.H),
        is_known_(static_cast<std::size_t>(bounds_.size() + 2 * qp.g.size()), false),
        dual_(stop) {}

  QpSolution run(const ArrayXd& multipliers);

 private:
  /// A constraint, or a side of the box.
  struct Row {
    Index constraint;  ///< Past the constraints: lower sides, then upper ones.
    Index first;       ///< Entry of its column in V that is not zero.
  };

  void add(Index constraint, const SoftQp::Group* group, Index column, double start);
  void add_side(Index constraint, double start);
  std::vector<double> most_lacking(const ArrayXd& lacking) const;
  bool add_broken(const VectorXd& x, const ArrayXd& lacking);
  VectorXd primal();
  bool is_solved(const VectorXd& x, const ArrayXd& lacking, QpSolution& solution) const;
  void push(Index constraint, int block, VectorXd column, double bound, double most, double start);

  const SoftQp& qp_;
  const double tolerance_;
  const StopCondition& stop_;
  const Index size_;
  const ArrayXd bounds_;
  math::BlockTridiagonal factors_;
  VectorXd y_;                     ///< L^-1 g
  std::vector<Row> rows_;          ///< The working set.
  std::vector<VectorXd> columns_;  ///< L^-1 a of each.
  std::vector<bool> is_known_;
  DualProblem dual_;
};

/// Adds the row with coefficients `column`, which are zero before `block`.
void ActiveSet::push(Index constraint, int block, VectorXd column, double bound, double most,
                     double start) {
  factors_.forward_in_place(column, block);
  const Index first = block * size_, length = column.size() - first;
  VectorXd row(dual_.size() + 1);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Index from = std::max(first, rows_[i].first);
    row[static_cast<Index>(i)] =
        column.tail(column.size() - from).dot(columns_[i].tail(column.size() - from));
  }
  row[dual_.size()] = column.tail(length).squaredNorm();
  is_known_[static_cast<std::size_t>(constraint)] = true;
  if (!(row[dual_.size()] > 0)) return;  // No step changes it.
  dual_.add(row, bound + column.tail(length).dot(y_.tail(length)), most, start);
  rows_.push_back({constraint, first});
  columns_.push_back(std::move(column));
}

void ActiveSet::add(Index constraint, const SoftQp::Group* group, Index i, double start) {
  VectorXd column = VectorXd::Zero(qp_.g.size());
  const Index first = group->block * size_;
  if (qp_.has_here(*group)) column.segment(first, size_) = group->here * group->at.col(i);
  if (qp_.has_next(*group)) {
    column.segment(first + size_, size_) = group->next * group->columns_next().col(i);
  }
  const int block = qp_.has_here(*group) ? group->block : group->block + 1;
  push(constraint, std::clamp(block, 0, qp_.H.block_count()), std::move(column),
       bounds_[constraint], qp_.penalty, start);
}

void ActiveSet::add_side(Index constraint, double start) {
  const Index n = qp_.g.size(), side = constraint - bounds_.size();
  const bool is_upper = side >= n;
  const Index j = is_upper ? side - n : side;
  VectorXd column = VectorXd::Zero(n);
  column[j] = is_upper ? -1 : 1;
  push(constraint, static_cast<int>(j / size_), std::move(column),
       is_upper ? -qp_.upper[j] : qp_.lower[j], kHard, start);
}

/// What is lacking most in each group, of constraints that are not in the working set; 0: nothing.
std::vector<double> ActiveSet::most_lacking(const ArrayXd& lacking) const {
  std::vector<double> most;
  Index k = 0;
  for (const SoftQp::Group& group : qp_.groups) {
    double& worst = most.emplace_back(0.0);
    for (const Index end = k + group.count(); k < end; ++k) {
      if (!is_known_[static_cast<std::size_t>(k)]) worst = std::max(worst, lacking[k]);
    }
  }
  return most;
}

/// Adds the constraints that x breaks most. @return whether there are any.
bool ActiveSet::add_broken(const VectorXd& x, const ArrayXd& lacking) {
  const std::size_t before = rows_.size();
  const std::vector<double> most_lacking = this->most_lacking(lacking);
  Index k = 0;
  for (std::size_t at = 0; at < qp_.groups.size() && !stop_(); ++at) {
    const SoftQp::Group& group = qp_.groups[at];
    // Neighbours on a path break together: what mends the worst of them mends the others.
    if ((at > 0 && most_lacking[at - 1] > most_lacking[at]) ||
        (at + 1 < most_lacking.size() && most_lacking[at + 1] > most_lacking[at])) {
      k += group.count();
      continue;
    }
    for (int n = 0; n < kAtOnce; ++n) {
      Index worst = -1;
      double most = 0;
      for (Index i = 0; i < group.count(); ++i) {
        if (lacking[k + i] <= most || is_known_[static_cast<std::size_t>(k + i)]) continue;
        most = lacking[k + i];
        worst = i;
      }
      if (worst >= 0) add(k + worst, &group, worst, 0);
    }
    k += group.count();
  }
  for (Index j = 0; j < x.size() && !stop_(); ++j) {
    const Index lower = bounds_.size() + j, upper = lower + x.size();
    if (x[j] < qp_.lower[j] && !is_known_[static_cast<std::size_t>(lower)]) add_side(lower, 0);
    if (x[j] > qp_.upper[j] && !is_known_[static_cast<std::size_t>(upper)]) add_side(upper, 0);
  }
  return rows_.size() > before;
}

/// The x that the multipliers lead to.
VectorXd ActiveSet::primal() {
  VectorXd x = -y_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double multiplier = dual_.lambda[static_cast<Index>(i)];
    if (multiplier == 0) continue;
    const Index length = x.size() - rows_[i].first;
    x.tail(length) += multiplier * columns_[i].tail(length);
  }
  factors_.backward_in_place(x);
  return x;
}

/// Whether x, moved into the box, is good enough: fills the solution with it.
bool ActiveSet::is_solved(const VectorXd& x, const ArrayXd& lacking, QpSolution& solution) const {
  const VectorXd margin = kInside * (qp_.upper - qp_.lower);
  solution.x = x.cwiseMax(qp_.lower + margin).cwiseMin(qp_.upper - margin);
  const VectorXd moved = solution.x - x;
  VectorXd H_moved = VectorXd::Zero(x.size());
  ArrayXd lacks = lacking;
  if (!moved.isZero(0)) {
    ArrayXd along;
    qp_.H.multiply(moved, H_moved);
    qp_.project(moved, along);
    lacks -= along;
  }
  // The multipliers bound the objective from below, as far as x is stationary for them.
  double left = H_moved.cwiseAbs().dot(qp_.upper - qp_.lower);
  const double lost = qp_.penalty * lacks.max(0.0).sum();
  left += lost;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Index side = rows_[i].constraint - bounds_.size(), n = x.size();
    const double multiplier = dual_.lambda[static_cast<Index>(i)];
    if (side < 0) {
      left -= multiplier * lacks[rows_[i].constraint];
    } else {
      left += multiplier * (side < n ? solution.x[side] - qp_.lower[side]
                                     : qp_.upper[side - n] - solution.x[side - n]);
    }
  }
  VectorXd Hx(x.size());
  qp_.H.multiply(solution.x, Hx);
  solution.value = solution.x.dot(0.5 * Hx + qp_.g) + lost;
  const double fallen = qp_.penalty * bounds_.max(0.0).sum() - solution.value;
  return left <= tolerance_ * fallen || left <= kNothingLeft;
}

QpSolution ActiveSet::run(const ArrayXd& multipliers) {
  QpSolution solution;
  solution.x = VectorXd::Zero(qp_.g.size());
  solution.multipliers = ArrayXd::Zero(bounds_.size());
  if (!factors_.factorise()) return solution;
  y_ = qp_.g;
  factors_.forward_in_place(y_);
  if (multipliers.size() == bounds_.size()) {
    Index k = 0;
    for (const SoftQp::Group& group : qp_.groups) {
      for (Index i = 0; i < group.count(); ++i, ++k) {
        if (multipliers[k] > 0 && !stop_())
          add(k, &group, i, std::min(multipliers[k], qp_.penalty));
      }
    }
  }
  ArrayXd lacking;
  while (solution.rounds < kMostRounds && !stop_()) {
    ++solution.rounds;
    dual_.solve();
    const VectorXd x = primal();
    qp_.project(x, lacking);
    lacking = bounds_ - lacking;
    solution.converged = is_solved(x, lacking, solution);
    if (solution.converged || !add_broken(x, lacking)) break;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].constraint >= bounds_.size()) continue;
    solution.multipliers[rows_[i].constraint] = dual_.lambda[static_cast<Index>(i)];
  }
  return solution;
}

}  // namespace

QpSolution solve(const SoftQp& qp, double tolerance, const ArrayXd& multipliers,
                 const StopCondition& stop) {
  const Index size = qp.g.size();
  expects(size == Index{qp.H.block_size()} * qp.H.block_count() && qp.lower.size() == size &&
              qp.upper.size() == size,
          "one entry per row of H");
  expects((qp.lower.array() < 0).all() && (qp.upper.array() > 0).all(),
          "0 lies strictly between the bounds");
  expects(qp.penalty > 0 && tolerance > 0, "penalty and tolerance are positive");
  return ActiveSet(qp, tolerance, stop).run(multipliers);
}

}  // namespace tandem::shortening
