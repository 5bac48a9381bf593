#include "tandem/robot/inverse_kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/math/so3.h"
#include "tandem/robot/joint_motion.h"

namespace tandem::robot {

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A descent that wins less than this factor in kPatience steps has settled in a local minimum.
constexpr double kProgress = 0.7;
constexpr int kPatience = 5;
/// Goals whose nearest miss is larger are called out of reach [m] and [rad].
constexpr double kFar = 1e-2;
/// Restarts by which the random seeds have spread from the given one over all positions.
constexpr int kSpread = 10;

struct Residual {
  double position = std::numeric_limits<double>::infinity();     ///< [m]
  double orientation = std::numeric_limits<double>::infinity();  ///< [rad]
  double norm() const { return std::hypot(position, orientation); }
};

std::string to_text(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

class Solver {
 public:
  Solver(const IkProblem& problem, const IkOptions& options)
      : model_(*problem.model), problem_(problem), options_(options) {
    const auto count = static_cast<Eigen::Index>(problem.columns.size());
    J_W_.resize(6, count);
    step_.resize(count);
    for (const int column : problem.columns) {
      const Joint& joint = joints()[index(model_.joint_of_position(column))];
      limits_.push_back(joint.limits);
    }
    find_path();
    positions_ = problem.positions;
    clamp();
    seed_ = positions_;
    forward_kinematics(model_, positions_, X_WL_);
  }

  const Eigen::VectorXd& positions() const { return positions_; }
  const Residual& residual() const { return residual_; }
  bool moves_link() const { return !path_.empty(); }

  /// The reason why no positions can reach the goal; empty if a bound does not exclude it.
  std::string out_of_reach() const;
  void draw(double spread, Rng& rng);
  bool descend();
  void unwind();

 private:
  /// A joint between the first moving one and the link.
  struct PathJoint {
    const Joint* joint;
    int column;  ///< Of J_W_; -1 if it stands still.
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  const std::vector<Joint>& joints() const { return model_.joints(); }

  void find_path();
  double& position(std::size_t column) { return positions_[problem_.columns[column]]; }
  double sampled_range(std::size_t column, double& lower) const;
  void clamp();
  void evaluate();
  void linearise();
  void make_step();

  const Model& model_;
  const IkProblem& problem_;
  const IkOptions& options_;
  std::vector<JointLimits> limits_;  ///< By column.
  std::vector<PathJoint> path_;
  Eigen::VectorXd seed_, positions_, step_;
  LinkPoses X_WL_;
  Eigen::Isometry3d X_WE_;
  Vector6d error_W_;
  Residual residual_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> J_W_;
};

void Solver::find_path() {
  for (int joint = model_.links()[index(problem_.link)].parent_joint; joint >= 0;) {
    const Joint& above = joints()[index(joint)];
    PathJoint entry{&above, -1};
    if (above.type != JointType::kFixed) {
      const auto found = std::ranges::find(problem_.columns, driving_position(joints(), above));
      if (found != problem_.columns.end()) {
        entry.column = static_cast<int>(found - problem_.columns.begin());
      }
    }
    path_.push_back(entry);
    joint = model_.links()[index(above.parent_link)].parent_joint;
  }
  while (!path_.empty() && path_.back().column < 0) path_.pop_back();
  std::ranges::reverse(path_);
}

std::string Solver::out_of_reach() const {
  // Between two moving joints the chain is rigid: the reach is at most the sum of these lengths and
  // of the strokes, seen from the origin of the first moving joint.
  const Joint& first = *path_.front().joint;
  const Eigen::Vector3d p_WA = X_WL_[index(first.parent_link)] * first.X_PJ.translation();
  Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
  double reach = 0;
  for (const PathJoint& entry : path_) {
    const Joint& joint = *entry.joint;
    if (&joint != &first) X_AB = X_AB * joint.X_PJ;
    if (entry.column < 0) {
      const Eigen::Isometry3d X_PC =
          X_WL_[index(joint.parent_link)].inverse() * X_WL_[index(joint.child_link)];
      X_AB = X_AB * joint.X_PJ.inverse() * X_PC;
      continue;
    }
    reach += X_AB.translation().norm();
    X_AB.setIdentity();
    if (joint.type != JointType::kPrismatic) continue;
    const JointLimits& limits = limits_[index(entry.column)];
    const double gain = joint.mimic ? joint.mimic->multiplier : 1;
    const double offset = joint.mimic ? joint.mimic->offset : 0;
    reach +=
        std::max(std::abs(gain * limits.lower + offset), std::abs(gain * limits.upper + offset));
  }
  reach += (X_AB * problem_.X_LE).translation().norm();
  const double distance = (problem_.X_WE.translation() - p_WA).norm();
  if (!(distance > reach + options_.position_tolerance)) return {};
  return "the goal is " + to_text(distance) + " m from joint '" + first.name +
         "', from where the chain reaches " + to_text(reach) + " m at most";
}

/// Length of the range to draw from, and its lower end; a joint without limits gets one turn.
double Solver::sampled_range(std::size_t column, double& lower) const {
  const JointLimits& limits = limits_[column];
  const double seed = seed_[problem_.columns[column]];
  lower = std::isfinite(limits.lower) ? limits.lower : seed - std::numbers::pi;
  const double upper = std::isfinite(limits.upper) ? limits.upper : seed + std::numbers::pi;
  return std::max(0.0, upper - lower);
}

/// Random positions, `spread` of the way from the seed to anywhere.
void Solver::draw(double spread, Rng& rng) {
  positions_ = seed_;
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    double lower = 0;
    const double range = sampled_range(i, lower);
    position(i) += spread * (lower + range * rng.uniform() - position(i));
  }
  clamp();
}

void Solver::clamp() {
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    position(i) = std::clamp(position(i), limits_[i].lower, limits_[i].upper);
  }
}

/// Poses along the path and what is missing to the goal.
void Solver::evaluate() {
  for (const PathJoint& entry : path_) {
    place_child(*entry.joint, joint_value(joints(), *entry.joint, positions_), X_WL_);
  }
  X_WE_ = X_WL_[index(problem_.link)] * problem_.X_LE;
  error_W_.head<3>() = problem_.X_WE.translation() - X_WE_.translation();
  const Eigen::Matrix3d R = problem_.X_WE.linear() * X_WE_.linear().transpose();
  error_W_.tail<3>() = math::log_map(Eigen::Quaterniond(R));
  residual_ = {error_W_.head<3>().norm(), error_W_.tail<3>().norm()};
}

void Solver::linearise() {
  J_W_.setZero();
  for (const PathJoint& entry : path_) {
    if (entry.column < 0) continue;
    add_joint_column(*entry.joint, X_WL_[index(entry.joint->child_link)], X_WE_.translation(),
                     J_W_.col(entry.column));
  }
}

/// Damped Newton step of the joints that are free to take it. A joint at its limit that would leave
/// it is taken out and the others share its part.
void Solver::make_step() {
  // Damping by the squared error keeps the order of convergence, tames singular poses far off, and
  // bounds the step: its norm is at most error / (2 sqrt(damping)).
  const double damping = 1e-12 + 0.05 * error_W_.squaredNorm();
  for (bool is_settled = false; !is_settled;) {
    Eigen::Matrix<double, 6, 6> A = damping * Eigen::Matrix<double, 6, 6>::Identity();
    A.noalias() += J_W_.lazyProduct(J_W_.transpose());
    step_.noalias() = J_W_.transpose() * A.llt().solve(error_W_);
    is_settled = true;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const bool leaves = (step_[column] > 0 && position(i) >= limits_[i].upper) ||
                          (step_[column] < 0 && position(i) <= limits_[i].lower);
      if (!leaves) continue;
      // Without its column the joint's step is exactly zero from here on.
      J_W_.col(column).setZero();
      is_settled = false;
    }
  }
}

/// Newton from `positions_`; true if it ends inside the tolerances.
bool Solver::descend() {
  double reference = std::numeric_limits<double>::infinity();
  Residual best;
  for (int i = 0, since = 0; i <= options_.iterations; ++i, ++since) {
    evaluate();
    if (residual_.position <= options_.position_tolerance &&
        residual_.orientation <= options_.orientation_tolerance) {
      return true;
    }
    if (residual_.norm() < best.norm()) best = residual_;
    if (residual_.norm() < kProgress * reference) {
      reference = residual_.norm();
      since = 0;
    }
    if (since >= kPatience || i == options_.iterations) break;
    linearise();
    make_step();
    for (std::size_t k = 0; k < limits_.size(); ++k) {
      position(k) += step_[static_cast<Eigen::Index>(k)];
    }
    clamp();
  }
  residual_ = best;
  return false;
}

/// Shifts joints by whole turns towards the seed, as far as their limits allow.
void Solver::unwind() {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const int source = model_.joint_of_position(problem_.columns[i]);
    const bool is_followed = std::ranges::any_of(
        joints(), [&](const Joint& j) { return j.mimic && j.mimic->joint == source; });
    if (joints()[index(source)].type == JointType::kPrismatic || is_followed) continue;
    const double q = position(i);
    const double fewest = std::ceil((limits_[i].lower - q) / kTurn);
    const double most = std::floor((limits_[i].upper - q) / kTurn);
    const double wanted = std::round((seed_[problem_.columns[i]] - q) / kTurn);
    if (fewest <= most) position(i) += kTurn * std::clamp(wanted, fewest, most);
  }
  clamp();
}

void check(const IkProblem& problem) {
  expects(problem.model != nullptr, "problem.model is given");
  const Model& model = *problem.model;
  expects(problem.link >= 0 && problem.link < static_cast<int>(model.links().size()),
          "problem.link is one of the model's");
  expects(problem.positions.size() == model.position_count() && problem.positions.allFinite(),
          "problem.positions are all positions of the model, finite");
  for (const int column : problem.columns) {
    expects(column >= 0 && column < model.position_count(), "problem.columns are positions");
  }
  for (const Eigen::Isometry3d& X : {problem.X_WE, problem.X_LE}) {
    expects(X.matrix().allFinite() && X.linear().isUnitary(1e-6),
            "problem.X_WE and X_LE are finite and rigid");
  }
}

std::string miss(const Residual& residual) {
  return to_text(residual.position) + " m and " + to_text(residual.orientation) + " rad";
}

/// What kept `attempts` descents from an accepted solution.
Error explain(const std::map<std::string, int>& refusals, const Residual& nearest,
              const std::string& subject, const std::string& attempts) {
  if (!refusals.empty()) {
    const auto most =
        std::ranges::max_element(refusals, {}, [](const auto& r) { return r.second; });
    int total = 0;
    for (const auto& [reason, count] : refusals) total += count;
    return {ErrorCode::kInfeasible, subject + ": blocked: the " + std::to_string(total) +
                                        " solutions found in " + attempts +
                                        " are all refused, most often (" +
                                        std::to_string(most->second) + " times) by " + most->first};
  }
  if (nearest.position > kFar || nearest.orientation > kFar) {
    return {ErrorCode::kInfeasible,
            subject + ": out of reach: none of " + attempts + " came nearer than " + miss(nearest)};
  }
  return {ErrorCode::kInfeasible, subject + ": not found in " + attempts +
                                      ", the nearest of which missed by " + miss(nearest) +
                                      "; allow more restarts or larger tolerances"};
}

}  // namespace

Result<Eigen::VectorXd> solve_ik(const IkProblem& problem, const IkOptions& options,
                                 const IkValidity& validity, const StopCondition& stop) {
  check(problem);
  expects(options.restarts >= 0 && options.iterations >= 0, "restarts and iterations are >= 0");
  const std::string& link = problem.model->links()[static_cast<std::size_t>(problem.link)].name;
  const std::string subject = "inverse kinematics of link '" + link + "'";
  Solver solver(problem, options);
  if (!solver.moves_link()) {
    return fail(ErrorCode::kInfeasible, subject + ": out of reach: no given joint moves the link");
  }
  if (const std::string reason = solver.out_of_reach(); !reason.empty()) {
    return fail(ErrorCode::kInfeasible, subject + ": out of reach: " + reason);
  }
  Rng rng(options.seed);
  Residual nearest;
  std::map<std::string, int> refusals;
  for (int attempt = 0; attempt <= options.restarts; ++attempt) {
    if (stop()) return std::unexpected(stop.error(subject));
    if (attempt > 0) solver.draw(std::min(1.0, attempt / double{kSpread}), rng);
    if (!solver.descend()) {
      if (solver.residual().norm() < nearest.norm()) nearest = solver.residual();
      continue;
    }
    solver.unwind();
    const std::string refusal = validity ? validity(solver.positions()) : std::string();
    if (refusal.empty()) return solver.positions();
    ++refusals[refusal];
  }
  return std::unexpected(
      explain(refusals, nearest, subject, std::to_string(options.restarts + 1) + " attempts"));
}

}  // namespace tandem::robot
