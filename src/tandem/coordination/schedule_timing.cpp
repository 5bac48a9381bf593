#include "tandem/coordination/schedule_timing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/coordination/interpolation.h"
#include "tandem/core/contract.h"
#include "tandem/math/bernstein.h"
#include "tandem/trajectory/piece_derivatives.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;
using motion::ArmMotion;
using motion::TimeMap;

namespace {

constexpr double kShortest = 2e-3;   ///< [s] of an interval: two control ticks.
constexpr double kCloseness = 1e-3;  ///< To which peaks are found while intervals change.

/// The times of places from the intervals between them.
std::vector<double> summed(const VectorXd& intervals) {
  std::vector<double> times{0};
  for (const double h : intervals) times.push_back(times.back() + h);
  return times;
}

/// One arm's map: the natural spline over the places between its waits at both ends.
TimeMap map_through(const std::vector<VectorXd>& places, Index arm,
                    const std::vector<double>& times) {
  const auto count = static_cast<Index>(places.size());
  const auto at = [&](Index k) { return places[static_cast<std::size_t>(k)][arm]; };
  Index first = 0, last = count - 1;
  while (first + 1 < count && at(first + 1) == at(0)) ++first;
  while (last > first + 1 && at(last - 1) == at(count - 1)) --last;
  if (first + 1 >= count) return *TimeMap::make({0, times.back()}, {{{at(0)}}});
  const double begin = times[static_cast<std::size_t>(first)];
  std::vector<double> own;
  VectorXd values(last - first + 1);
  for (Index k = first; k <= last; ++k) {
    own.push_back(times[static_cast<std::size_t>(k)] - begin);
    values[k - first] = at(k);
  }
  const TimeMap active = coordination::interpolate(own, values, Interpolation::kCubic);
  std::vector<double> knots{0};
  std::vector<TimeMap::Segment> segments;
  if (first > 0) {
    knots.push_back(begin);
    segments.push_back({at(0)});
  }
  for (std::size_t k = 0; k < active.segments().size(); ++k) {
    knots.push_back(times[static_cast<std::size_t>(first) + k + 1]);
    segments.push_back(active.segments()[k]);
  }
  if (last + 1 < count) {
    knots.push_back(times.back());
    segments.push_back({at(count - 1)});
  }
  auto map = TimeMap::make(std::move(knots), std::move(segments));
  expects(map.has_value(), "times of places are finite and increase");
  return *std::move(map);
}

}  // namespace

ScheduleTiming::ScheduleTiming(const std::vector<ArmMotion>& arms,
                               const std::vector<robot::JointLimits>& limits)
    : arms_(arms), limits_(limits) {
  std::size_t joints = 0;
  for (const ArmMotion& arm : arms_) joints += static_cast<std::size_t>(arm.dof());
  expects(joints == limits_.size(), "one limit per joint is needed");
}

void ScheduleTiming::interpolate(const std::vector<VectorXd>& places, const VectorXd& intervals) {
  times_ = summed(intervals);
  moved_.clear();
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    auto moved = arms_[i].along(map_through(places, static_cast<Index>(i), times_));
    expects(moved.has_value(), "places of a schedule are within the motions' durations");
    moved_.push_back(*std::move(moved));
  }
}

/// By interval, the factor by which it alone would have to be longer.
VectorXd ScheduleTiming::local_scales() {
  VectorXd scales = VectorXd::Zero(static_cast<Index>(times_.size()) - 1);
  std::size_t first = 0;
  for (const ArmMotion& arm : moved_) {
    Index k = 0;
    for (const ArmMotion::Piece& piece : arm.pieces()) {
      const double middle = 0.5 * (piece.t0 + piece.t1);
      while (k + 1 < scales.size() && times_[static_cast<std::size_t>(k) + 1] <= middle) ++k;
      if (piece.spline < 0) continue;
      const trajectory::PieceDerivatives derivatives(arm, piece);
      // Only what exceeds the interval's worst so far is looked at closely.
      double& scale = scales[k];
      const auto widen = [&](int order, Index j, double limit, double worst) {
        if (std::isinf(limit)) return worst;
        return math::largest_magnitude(derivatives(order, j), worst * limit, kCloseness) / limit;
      };
      double velocity = scale, acceleration = scale * scale, jerk = acceleration * scale;
      for (Index j = 0; j < arm.dof(); ++j) {
        const robot::JointLimits& limit = limits_[first + static_cast<std::size_t>(j)];
        velocity = widen(1, j, limit.velocity, velocity);
        acceleration = widen(2, j, limit.acceleration, acceleration);
        jerk = widen(3, j, limit.jerk, jerk);
      }
      scale = std::max({velocity, std::sqrt(acceleration), std::cbrt(jerk)});
    }
    first += static_cast<std::size_t>(arm.dof());
  }
  return scales;
}

/// Scales time so that the limits just hold, exactly.
void ScheduleTiming::finish() {
  // Rounding of knots and coefficients leaves the last bits to trial.
  double margin = 1e-12;
  for (bool first = true;; first = false, margin *= 4) {
    const trajectory::Extremes reached = trajectory::extremes(motion::CellMotion(moved_));
    const double factor = trajectory::stretch_factor(reached, limits_);
    if (!first && factor <= 1) return;
    const double slower = (first ? factor : std::max(factor, 1.0)) * (1 + margin);
    if (!(slower > 0)) return;  // Nothing moves.
    for (ArmMotion& arm : moved_) arm = arm.stretched(slower);
    for (double& t : times_) t *= slower;
  }
}

std::vector<TimeMap> ScheduleTiming::fit(const std::vector<VectorXd>& places, VectorXd intervals) {
  expects(places.size() >= 2 && intervals.size() + 1 == static_cast<Index>(places.size()),
          "a schedule of N places has N - 1 intervals");
  constexpr int kRounds = 10;
  constexpr double kEven = 0.005;
  constexpr double kMost = 2;  ///< Of what an interval changes by in a round.
  VectorXd best = intervals.cwiseMax(kShortest);
  double least = std::numeric_limits<double>::infinity();
  intervals = best;
  for (int round = 0; round <= kRounds; ++round) {
    interpolate(places, intervals);
    const VectorXd scales = local_scales();
    const double makespan = intervals.sum() * scales.maxCoeff();
    if (makespan < least) {
      least = makespan;
      best = intervals;
    }
    // Where every interval is as near its limits as any other, another round gains nothing.
    if (scales.minCoeff() > (1 - kEven) * scales.maxCoeff()) break;
    intervals.array() *= scales.array().sqrt().max(1 / kMost).min(kMost);
    intervals = intervals.cwiseMax(kShortest);
  }
  interpolate(places, best);
  finish();
  std::vector<TimeMap> maps;
  for (const ArmMotion& arm : moved_) maps.push_back(*arm.map());
  return maps;
}

std::vector<TimeMap> ScheduleTiming::stop_and_go(const std::vector<VectorXd>& places) {
  // From rest to rest on [0, 1]: 10 u^3 - 15 u^4 + 6 u^5.
  const auto edge_maps = [&](std::size_t k, double h) {
    std::vector<TimeMap::Segment> segments;
    for (Index arm = 0; arm < places[k].size(); ++arm) {
      const double d = places[k + 1][arm] - places[k][arm], c = h * h * h;
      segments.push_back(
          {places[k][arm], 0, 0, 10 * d / c, -15 * d / (c * h), 6 * d / (c * h * h)});
    }
    return segments;
  };
  std::vector<std::vector<TimeMap::Segment>> by_arm(arms_.size());
  VectorXd intervals(static_cast<Index>(places.size()) - 1);
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const auto trial = edge_maps(k, 1);
    moved_.clear();
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      moved_.push_back(*arms_[i].along(*TimeMap::make({0, 1}, {trial[i]})));
    }
    const trajectory::Extremes reached = trajectory::extremes(motion::CellMotion(moved_));
    const double h = std::max(trajectory::stretch_factor(reached, limits_), kShortest);
    const auto fitted = edge_maps(k, h);
    for (std::size_t i = 0; i < arms_.size(); ++i) by_arm[i].push_back(fitted[i]);
    intervals[static_cast<Index>(k)] = h;
  }
  times_ = summed(intervals);
  moved_.clear();
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    moved_.push_back(*arms_[i].along(*TimeMap::make(times_, by_arm[i])));
  }
  finish();
  std::vector<TimeMap> maps;
  for (const ArmMotion& arm : moved_) maps.push_back(*arm.map());
  return maps;
}

}  // namespace tandem::coordination
