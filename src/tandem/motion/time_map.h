#pragma once
/// c(t): from real time to the local time of one arm's motion.

#include <array>
#include <utility>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::motion {

/// Piecewise polynomial c(t) on [0, duration()], of degree up to 5: on segment k, with
/// s = t - knot_k, c(t) = c0 + c1 s + ... + c5 s^5. It may go back, and what it exceeds of a
/// motion's time is cut off where the two are put together. Immutable and thread-safe.
/// Ref: eq:Coord.
class TimeMap {
 public:
  static constexpr int kDegree = 5;
  using Segment = std::array<double, kDegree + 1>;  ///< c0 .. c5

  /// @param knots     real times, strictly increasing, first is 0, at least 2 [s].
  /// @param segments  knots.size() - 1, finite.
  /// @return kInvalidInput naming the knot or segment otherwise. Continuity is not required.
  static Result<TimeMap> make(std::vector<double> knots, std::vector<Segment> segments);

  double duration() const { return knots_.back(); }  ///< Real time [s].
  const std::vector<double>& knots() const { return knots_; }
  const std::vector<Segment>& segments() const { return segments_; }
  int segment_at(double t) const;  ///< Index of the segment that holds t, clamped.

  /// c [s] and its first, second and third derivative.
  using Derivatives = std::array<double, 4>;
  /// At `t`; outside [0, duration()] c stands still at its end.
  Derivatives at(double t) const;
  /// Of segment k at `t`, also where another segment holds t.
  Derivatives on_segment(int k, double t) const;
  double operator()(double t) const;

  /// Least and largest c over [t0, t1], clamped into [0, duration()]; exact.
  std::pair<double, double> range(double t0, double t1) const;
  /// Times in segment k, ends included, at which c has the value `local`, ascending. Where c only
  /// touches it there may be one or none.
  std::vector<double> crossings(int k, double local) const;

  /// The same map run `factor` times slower (> 0).
  TimeMap stretched(double factor) const;

 private:
  TimeMap(std::vector<double> knots, std::vector<Segment> segments)
      : knots_(std::move(knots)), segments_(std::move(segments)) {}
  std::vector<double> knots_;
  std::vector<Segment> segments_;
};

}  // namespace tandem::motion
