#pragma once
/// Piecewise cubic q(t) for several joints on common knots.

#include <vector>

#include "tandem/core/result.h"
#include "tandem/motion/motion.h"

namespace tandem::motion {

/// Where the slope c1 + 2 c2 s + 3 c3 s^2 of a cubic vanishes: up to two points, in no order. A
/// constant has none.
struct StationaryPoints {
  double s[2] = {};
  int count = 0;
};
/// Robust against cancellation and against leading coefficients that are zero or tiny.
StationaryPoints stationary_points(double c1, double c2, double c3);

/// On segment k, with s = t - knot_k: q(t) = c0 + c1 s + c2 s^2 + c3 s^3 per joint.
class PiecewiseCubic final : public Motion {
 public:
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 4>;  ///< dof x (c0, c1, c2, c3)

  /// @param knots     strictly increasing, first is 0, at least 2 [s].
  /// @param segments  knots.size() - 1 matrices with equal row counts.
  /// @return kInvalidInput naming the knot or segment otherwise. Continuity is not required.
  static Result<PiecewiseCubic> make(std::vector<double> knots, std::vector<Coefficients> segments);

  int dof() const override { return static_cast<int>(segments_.front().rows()); }
  double duration() const override { return knots_.back(); }
  void position(double t, Eigen::Ref<Eigen::VectorXd> q) const override;
  JointState at(double t) const override;
  void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const override;
  /// D_j = max |q_j(t) - q_j(m)| over t in [t0, t1], for any m; all clamped into [0, duration()].
  void deviation_from(double m, double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const;

  const std::vector<double>& knots() const { return knots_; }
  const std::vector<Coefficients>& segments() const { return segments_; }
  int segment_at(double t) const;  ///< Index of the segment that holds t, clamped.
  /// Everything on segment k at `t`, also where another segment holds t.
  JointState on_segment(int k, double t) const;

  /// Joints [first, first + count) as a motion of their own.
  PiecewiseCubic joints(int first, int count) const;
  /// This, then `next` from this end on; knots and coefficients are kept as they are.
  PiecewiseCubic then(const PiecewiseCubic& next) const;
  /// The same curve run `factor` times slower (> 0).
  PiecewiseCubic stretched(double factor) const;

  /// Largest jumps over the inner knots, over all joints: position, velocity, acceleration.
  Eigen::Vector3d largest_jumps() const;

 private:
  PiecewiseCubic(std::vector<double> knots, std::vector<Coefficients> segments)
      : knots_(std::move(knots)), segments_(std::move(segments)) {}
  std::vector<double> knots_;
  std::vector<Coefficients> segments_;
};

}  // namespace tandem::motion
