#include "tandem/trajectory/limit_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "tandem/core/contract.h"
#include "tandem/trajectory/piece_derivatives.h"

namespace tandem::trajectory {

using Eigen::Index, Eigen::VectorXd;

namespace {

Extremes nothing_seen(Index dof) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {VectorXd::Constant(dof, kInfinity), VectorXd::Constant(dof, -kInfinity),
          VectorXd::Zero(dof), VectorXd::Zero(dof), VectorXd::Zero(dof)};
}

/// Positions between two times, clamped into the motion's.
void widen_positions(const motion::PiecewiseCubic& motion, double from, double to, Extremes& e) {
  const auto& knots = motion.knots();
  from = std::clamp(from, 0.0, knots.back());
  to = std::clamp(to, 0.0, knots.back());
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double low = std::max(from, knots[k]) - knots[k];
    const double high = std::min(to, knots[k + 1]) - knots[k];
    if (low > high) continue;
    for (Index j = 0; j < motion.dof(); ++j) {
      const auto c = motion.segments()[k].row(j);
      const auto position = [&](double s) {
        const double q = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        e.lowest[j] = std::min(e.lowest[j], q);
        e.highest[j] = std::max(e.highest[j], q);
      };
      position(low);
      position(high);
      const motion::StationaryPoints points = motion::stationary_points(c[1], c[2], c[3]);
      for (int i = 0; i < points.count; ++i) {
        if (points.s[i] > low && points.s[i] < high) position(points.s[i]);
      }
    }
  }
}

/// Velocities, accelerations and jerks of q(c(t)).
void widen_derivatives(const motion::ArmMotion& motion, Extremes& e) {
  std::vector<PieceDerivatives> pieces;
  for (const motion::ArmMotion::Piece& piece : motion.pieces()) pieces.emplace_back(motion, piece);
  VectorXd* const largest[] = {&e.velocity, &e.acceleration, &e.jerk};
  for (Index j = 0; j < motion.dof(); ++j) {
    for (int order = 1; order <= 3; ++order) {
      double& most = (*largest[order - 1])[j];
      // The ends of all pieces first: then few pieces are left whose bounds exceed the largest.
      for (const PieceDerivatives& piece : pieces) {
        const math::Bernstein p = piece(order, j);
        most = std::max({most, std::abs(p.front()), std::abs(p.back())});
      }
      for (const PieceDerivatives& piece : pieces) {
        most = math::largest_magnitude(piece(order, j), most);
      }
    }
  }
}

}  // namespace

Extremes extremes(const motion::PiecewiseCubic& motion) {
  Extremes e = nothing_seen(motion.dof());
  widen_positions(motion, 0, motion.duration(), e);
  const auto& knots = motion.knots();
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double h = knots[k + 1] - knots[k];
    for (Index j = 0; j < motion.dof(); ++j) {
      const auto c = motion.segments()[k].row(j);
      const auto velocity = [&](double s) {
        e.velocity[j] = std::max(e.velocity[j], std::abs(c[1] + s * (2 * c[2] + 3 * s * c[3])));
      };
      velocity(0);
      velocity(h);
      if (const double s = -c[2] / (3 * c[3]); s > 0 && s < h) velocity(s);
      e.acceleration[j] =
          std::max({e.acceleration[j], std::abs(2 * c[2]), std::abs(2 * c[2] + 6 * h * c[3])});
      e.jerk[j] = std::max(e.jerk[j], std::abs(6 * c[3]));
    }
  }
  return e;
}

Extremes extremes(const motion::ArmMotion& motion) {
  if (!motion.map()) return extremes(motion.spline());
  Extremes e = nothing_seen(motion.dof());
  const auto [least, largest] = motion.map()->range(0, motion.duration());
  widen_positions(motion.spline(), least, largest, e);
  widen_derivatives(motion, e);
  return e;
}

Extremes extremes(const motion::CellMotion& motion) {
  Extremes e = nothing_seen(motion.dof());
  Index first = 0;
  for (const motion::ArmMotion& arm : motion.arms()) {
    const Extremes own = extremes(arm);
    const Index n = arm.dof();
    e.lowest.segment(first, n) = own.lowest;
    e.highest.segment(first, n) = own.highest;
    e.velocity.segment(first, n) = own.velocity;
    e.acceleration.segment(first, n) = own.acceleration;
    e.jerk.segment(first, n) = own.jerk;
    first += n;
  }
  return e;
}

std::vector<LimitViolation> check_limits(const Extremes& e,
                                         const std::vector<robot::JointLimits>& limits,
                                         double tolerance) {
  expects(static_cast<std::size_t>(e.lowest.size()) == limits.size(),
          "one limit per joint is needed");
  struct Excess {
    double amount;
    LimitViolation violation;
  };
  std::vector<Excess> found;
  const auto note = [&](double amount, int joint, LimitKind kind, double value, double limit) {
    if (amount > tolerance) found.push_back({amount, {joint, kind, value, limit}});
  };
  for (int j = 0; j < e.lowest.size(); ++j) {
    const robot::JointLimits& limit = limits[static_cast<std::size_t>(j)];
    note(limit.lower - e.lowest[j], j, LimitKind::kPosition, e.lowest[j], limit.lower);
    note(e.highest[j] - limit.upper, j, LimitKind::kPosition, e.highest[j], limit.upper);
    const auto relative = [&](LimitKind kind, double value, double most) {
      if (std::isfinite(most)) note((value - most) / most, j, kind, value, most);
    };
    relative(LimitKind::kVelocity, e.velocity[j], limit.velocity);
    relative(LimitKind::kAcceleration, e.acceleration[j], limit.acceleration);
    relative(LimitKind::kJerk, e.jerk[j], limit.jerk);
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Excess::amount);
  std::vector<LimitViolation> violations;
  for (const Excess& excess : found) violations.push_back(excess.violation);
  return violations;
}

std::string describe(const LimitViolation& violation, const std::vector<std::string>& joint_names) {
  expects(violation.joint >= 0 && static_cast<std::size_t>(violation.joint) < joint_names.size(),
          "a violation needs the names of all joints");
  struct Quantity {
    const char *name, *unit;
  };
  // Names alone do not tell turning from sliding joints.
  constexpr Quantity kQuantities[] = {{"position", "rad or m"},
                                      {"velocity", "rad/s or m/s"},
                                      {"acceleration", "rad/s^2 or m/s^2"},
                                      {"jerk", "rad/s^3 or m/s^3"}};
  const Quantity& quantity = kQuantities[static_cast<std::size_t>(violation.kind)];
  std::ostringstream text;
  text << quantity.name << " of " << joint_names[static_cast<std::size_t>(violation.joint)]
       << " reaches " << violation.value << ", its limit is " << violation.limit << " ["
       << quantity.unit << "]";
  return text.str();
}

double stretch_factor(const Extremes& extremes, const std::vector<robot::JointLimits>& limits) {
  expects(static_cast<std::size_t>(extremes.velocity.size()) == limits.size(),
          "one limit per joint is needed");
  double factor = 0;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const auto j = static_cast<Index>(i);
    factor = std::max({factor, extremes.velocity[j] / limits[i].velocity,
                       std::sqrt(extremes.acceleration[j] / limits[i].acceleration),
                       std::cbrt(extremes.jerk[j] / limits[i].jerk)});
  }
  return factor;
}

}  // namespace tandem::trajectory
