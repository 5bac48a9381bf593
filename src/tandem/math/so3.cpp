#include "tandem/math/so3.h"

#include <cmath>

namespace tandem::math {

namespace {

// Below this angle three terms of each series are exact to rounding.
constexpr double kSmallAngle = 1e-3;  // [rad]

}  // namespace

Eigen::Vector3d log_map(const Eigen::Quaterniond& u) {
  // u and -u are one rotation; the one with w >= 0 is the shortest arc.
  const double sign = u.w() < 0 ? -1.0 : 1.0;
  const double w = sign * u.w(), v = u.vec().norm();
  double angle_per_sine;
  if (v < kSmallAngle * w) {
    const double x = v / w;
    angle_per_sine = 2 / w * (1 - x * x / 3 + x * x * x * x / 5);
  } else {
    angle_per_sine = 2 * std::atan2(v, w) / v;
  }
  return sign * angle_per_sine * u.vec();
}

Eigen::Quaterniond exp_map(const Eigen::Vector3d& p) {
  const double angle = p.norm();
  const double sine_per_angle = angle < kSmallAngle
                                    ? 0.5 - angle * angle / 48 + std::pow(angle, 4) / 3840
                                    : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond u;
  u.w() = std::cos(0.5 * angle);
  u.vec() = sine_per_angle * p;
  return u;
}

Eigen::Matrix3d log_map_jacobian(const Eigen::Vector3d& p) {
  const double angle2 = p.squaredNorm(), angle = std::sqrt(angle2);
  // (1 - gamma) / |p|^2 loses digits as 1e-16 / |p|^2, so its series serves up to a larger angle.
  constexpr double kSeries = 0.1;
  double factor;
  if (angle < kSeries) {
    factor = 1.0 / 12 + angle2 * (1.0 / 720 + angle2 * (1.0 / 30240 + angle2 / 1209600));
  } else {
    factor = (1 - 0.5 * angle / std::tan(0.5 * angle)) / angle2;
  }
  Eigen::Matrix3d P;
  P << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  return Eigen::Matrix3d::Identity() - 0.5 * P + factor * P * P;
}

}  // namespace tandem::math
