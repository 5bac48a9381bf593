#include "tandem/motion/piecewise_cubic.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tandem/core/contract.h"
#include "tandem/motion/knots.h"

namespace tandem::motion {

namespace {

using Coefficients = PiecewiseCubic::Coefficients;

double value(const Coefficients& c, Eigen::Index j, double s) {
  return c(j, 0) + s * (c(j, 1) + s * (c(j, 2) + s * c(j, 3)));
}

}  // namespace

StationaryPoints stationary_points(double c1, double c2, double c3) {
  // c1 + 2 c2 s + 3 c3 s^2 = 0 without cancellation: the larger root first, the other from the
  // product of both. A vanishing c3 sends the larger one to infinity, where nobody looks.
  StationaryPoints points;
  const double discriminant = c2 * c2 - 3 * c1 * c3;
  if (!(discriminant >= 0)) return points;
  const double r = -(c2 + std::copysign(std::sqrt(discriminant), c2));
  if (c3 != 0) points.s[points.count++] = r / (3 * c3);
  if (r != 0) points.s[points.count++] = c1 / r;
  return points;
}

Result<PiecewiseCubic> PiecewiseCubic::make(std::vector<double> knots,
                                            std::vector<Coefficients> segments) {
  const auto invalid = [](const std::string& what) {
    return fail(ErrorCode::kInvalidInput, "piecewise cubic: " + what);
  };
  if (auto valid = check_knots(knots, segments.size()); !valid) {
    return invalid(valid.error().message);
  }
  if (segments[0].rows() == 0) return invalid("segment 0 has no joints");
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].rows() != segments[0].rows()) {
      return invalid("segment " + std::to_string(k) + " has " + std::to_string(segments[k].rows()) +
                     " joints, segment 0 has " + std::to_string(segments[0].rows()));
    }
    if (!segments[k].allFinite()) {
      return invalid("segment " + std::to_string(k) + " has a coefficient that is not finite");
    }
  }
  return PiecewiseCubic(std::move(knots), std::move(segments));
}

int PiecewiseCubic::segment_at(double t) const { return motion::segment_at(knots_, t); }

void PiecewiseCubic::position(double t, Eigen::Ref<Eigen::VectorXd> q) const {
  const double clamped = std::clamp(t, 0.0, duration());
  const auto k = static_cast<std::size_t>(segment_at(clamped));
  const Coefficients& c = segments_[k];
  const double s = clamped - knots_[k];
  q = c.col(0) + s * (c.col(1) + s * (c.col(2) + s * c.col(3)));
}

JointState PiecewiseCubic::on_segment(int k, double t) const {
  const Coefficients& c = segments_[static_cast<std::size_t>(k)];
  const double s = t - knots_[static_cast<std::size_t>(k)];
  return {c.col(0) + s * (c.col(1) + s * (c.col(2) + s * c.col(3))),
          c.col(1) + s * (2 * c.col(2) + 3 * s * c.col(3)), 2 * c.col(2) + 6 * s * c.col(3),
          6 * c.col(3)};
}

JointState PiecewiseCubic::at(double t) const {
  const double clamped = std::clamp(t, 0.0, duration());
  JointState state = on_segment(segment_at(clamped), clamped);
  if (t < 0 || t > duration()) state.qd = state.qdd = state.qddd = Eigen::VectorXd::Zero(dof());
  return state;
}

void PiecewiseCubic::deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const {
  deviation_from(0.5 * (t0 + t1), t0, t1, D);
}

void PiecewiseCubic::deviation_from(double m, double t0, double t1,
                                    Eigen::Ref<Eigen::VectorXd> D) const {
  const double middle = std::clamp(m, 0.0, duration());
  const double from = std::clamp(t0, 0.0, duration()), to = std::clamp(t1, 0.0, duration());
  const auto first = static_cast<std::size_t>(segment_at(from));
  const auto last = static_cast<std::size_t>(segment_at(to));
  const auto at_middle = static_cast<std::size_t>(segment_at(middle));
  for (Eigen::Index j = 0; j < dof(); ++j) {
    const double q_m = value(segments_[at_middle], j, middle - knots_[at_middle]);
    double most = 0;
    for (std::size_t k = first; k <= last; ++k) {
      const Coefficients& c = segments_[k];
      const double low = std::max(from, knots_[k]) - knots_[k];
      const double high = std::min(to, knots_[k + 1]) - knots_[k];
      most = std::max({most, std::abs(value(c, j, low) - q_m), std::abs(value(c, j, high) - q_m)});
      const StationaryPoints points = stationary_points(c(j, 1), c(j, 2), c(j, 3));
      for (int i = 0; i < points.count; ++i) {
        const double s = points.s[i];
        if (s > low && s < high) most = std::max(most, std::abs(value(c, j, s) - q_m));
      }
    }
    D[j] = most;
  }
}

PiecewiseCubic PiecewiseCubic::joints(int first, int count) const {
  expects(first >= 0 && count >= 1 && first + count <= dof(), "joints are out of range");
  std::vector<Coefficients> segments;
  segments.reserve(segments_.size());
  for (const Coefficients& c : segments_) segments.push_back(c.middleRows(first, count));
  return {knots_, std::move(segments)};
}

PiecewiseCubic PiecewiseCubic::then(const PiecewiseCubic& next) const {
  expects(next.dof() == dof(), "motions that follow each other need the same joints");
  PiecewiseCubic both = *this;
  for (std::size_t k = 1; k < next.knots_.size(); ++k) {
    both.knots_.push_back(duration() + next.knots_[k]);
    expects(both.knots_.back() > *(both.knots_.end() - 2), "a knot interval vanished in rounding");
  }
  both.segments_.insert(both.segments_.end(), next.segments_.begin(), next.segments_.end());
  return both;
}

PiecewiseCubic PiecewiseCubic::stretched(double factor) const {
  expects(factor > 0 && std::isfinite(factor), "a stretch factor must be positive and finite");
  PiecewiseCubic slower = *this;
  for (double& knot : slower.knots_) knot *= factor;
  for (Coefficients& c : slower.segments_) {
    c.col(1) /= factor;
    c.col(2) /= factor * factor;
    c.col(3) /= factor * factor * factor;
  }
  return slower;
}

Eigen::Vector3d PiecewiseCubic::largest_jumps() const {
  Eigen::Vector3d jumps = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k + 1 < segments_.size(); ++k) {
    const Coefficients &c = segments_[k], &next = segments_[k + 1];
    const double h = knots_[k + 1] - knots_[k];
    const Eigen::VectorXd q = c.col(0) + h * (c.col(1) + h * (c.col(2) + h * c.col(3)));
    const Eigen::VectorXd qd = c.col(1) + h * (2 * c.col(2) + 3 * h * c.col(3));
    const Eigen::VectorXd qdd = 2 * c.col(2) + 6 * h * c.col(3);
    jumps = jumps.cwiseMax(Eigen::Vector3d((next.col(0) - q).cwiseAbs().maxCoeff(),
                                           (next.col(1) - qd).cwiseAbs().maxCoeff(),
                                           (2 * next.col(2) - qdd).cwiseAbs().maxCoeff()));
  }
  return jumps;
}

}  // namespace tandem::motion
