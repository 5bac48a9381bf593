#pragma once
/// The motion of one arm, q(t) or q(c(t)), and those of all arms of a cell.

#include <memory>
#include <optional>

#include "tandem/motion/piecewise_cubic.h"
#include "tandem/motion/time_map.h"

namespace tandem::motion {

/// A spline q(tau) run in its own time, or at the local times tau = c(t) of a map. What c(t) is
/// outside [0, spline().duration()] is cut off: there the arm waits at the spline's end. Copies
/// share the spline.
class ArmMotion final : public Motion {
 public:
  ArmMotion(PiecewiseCubic spline)  // NOLINT: a spline is such a motion.
      : spline_(std::make_shared<const PiecewiseCubic>(std::move(spline))) {}
  /// The same spline along a map.
  /// @return kInvalidInput naming the knot if c is outside the spline's time at a knot, by more
  /// than a nanosecond.
  Result<ArmMotion> along(TimeMap map) const;

  int dof() const override { return spline_->dof(); }
  double duration() const override { return map_ ? map_->duration() : spline_->duration(); }
  void position(double t, Eigen::Ref<Eigen::VectorXd> q) const override;
  /// By the chain rule. Ref: eq:c, eq:cdot, eq:cddot.
  JointState at(double t) const override;
  /// Exact: the range of c, then that of the spline over it.
  void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const override;

  const PiecewiseCubic& spline() const { return *spline_; }
  const std::optional<TimeMap>& map() const { return map_; }

  /// A stretch of time on which every joint is one polynomial.
  struct Piece {
    double t0, t1;
    int map;     ///< Segment of the map; -1 without one.
    int spline;  ///< Segment of the spline; -1 where c is cut off and the arm waits.
  };
  /// All of them in order: cut at the knots of c and where c passes knots of the spline, but for
  /// where it passes one by no more than rounding.
  std::vector<Piece> pieces() const;
  /// Everything at `t` as this piece continues it.
  JointState on_piece(const Piece& piece, double t) const;

  /// The same motion run `factor` times slower (> 0).
  ArmMotion stretched(double factor) const;
  /// Largest jumps between pieces, over all joints: position, velocity, acceleration.
  Eigen::Vector3d largest_jumps() const;

 private:
  JointState composed(const TimeMap::Derivatives& c, int segment) const;
  /// Of the spline while c is on its segment k and crosses no knot; -1 where c is cut off.
  int segment_between(int k, double t0, double t1) const;

  std::shared_ptr<const PiecewiseCubic> spline_;
  std::optional<TimeMap> map_;
};

/// Motions of several arms side by side, each on knots of its own; shorter ones wait at their end.
class CellMotion final : public Motion {
 public:
  explicit CellMotion(std::vector<ArmMotion> arms);
  int dof() const override { return dof_; }
  double duration() const override { return duration_; }
  void position(double t, Eigen::Ref<Eigen::VectorXd> q) const override;
  JointState at(double t) const override;
  void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const override;
  const std::vector<ArmMotion>& arms() const { return arms_; }

 private:
  std::vector<ArmMotion> arms_;
  int dof_ = 0;
  double duration_ = 0;
};

}  // namespace tandem::motion
