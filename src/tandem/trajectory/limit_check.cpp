#include "tandem/trajectory/limit_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tandem/core/contract.h"

namespace tandem::trajectory {

using Eigen::Index, Eigen::VectorXd;

Extremes extremes(const motion::PiecewiseCubic& motion) {
  const Index dof = motion.dof();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extremes e{VectorXd::Constant(dof, kInfinity), VectorXd::Constant(dof, -kInfinity),
             VectorXd::Zero(dof), VectorXd::Zero(dof), VectorXd::Zero(dof)};
  const auto& knots = motion.knots();
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double h = knots[k + 1] - knots[k];
    for (Index j = 0; j < dof; ++j) {
      const auto c = motion.segments()[k].row(j);
      const auto position = [&](double s) {
        const double q = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        e.lowest[j] = std::min(e.lowest[j], q);
        e.highest[j] = std::max(e.highest[j], q);
      };
      const auto velocity = [&](double s) {
        e.velocity[j] = std::max(e.velocity[j], std::abs(c[1] + s * (2 * c[2] + 3 * s * c[3])));
      };
      position(0);
      position(h);
      const motion::StationaryPoints points = motion::stationary_points(c[1], c[2], c[3]);
      for (int i = 0; i < points.count; ++i) {
        if (points.s[i] > 0 && points.s[i] < h) position(points.s[i]);
      }
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

std::vector<LimitViolation> check_limits(const motion::PiecewiseCubic& motion,
                                         const std::vector<robot::JointLimits>& limits,
                                         double tolerance) {
  expects(static_cast<std::size_t>(motion.dof()) == limits.size(), "one limit per joint is needed");
  const Extremes e = extremes(motion);
  struct Excess {
    double amount;
    LimitViolation violation;
  };
  std::vector<Excess> found;
  const auto note = [&](double amount, int joint, LimitKind kind, double value, double limit) {
    if (amount > tolerance) found.push_back({amount, {joint, kind, value, limit}});
  };
  for (int j = 0; j < motion.dof(); ++j) {
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
