#include "tandem/coordination/schedule_timing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/coordination/interpolation.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;
using motion::ArmMotion;
using motion::TimeMap;

namespace {

constexpr double kShortest = 2e-3;  ///< [s] of an interval: two control ticks.

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

/// How near its limits q(c(t)) comes on a segment of c: at even times, and where c passes knots of
/// q, where accelerations peak.
class PeakSampler {
 public:
  using Slowness = Eigen::Ref<const Eigen::ArrayXXd>;
  PeakSampler(const motion::PiecewiseCubic& spline, const Slowness& slowness)
      : spline_(spline), slowness_(slowness) {}

  void sample(const TimeMap& map, int segment) {
    constexpr int kSamples = 8;
    most_[0] = most_[1] = most_[2] = 0;
    const double t0 = map.knots()[static_cast<std::size_t>(segment)];
    const double h = map.knots()[static_cast<std::size_t>(segment) + 1] - t0;
    auto before = map.on_segment(segment, t0);
    if (before[1] == 0 && before[2] == 0 && before[3] == 0) return;  // A wait.
    look(before);
    for (int n = 1; n <= kSamples; ++n) {
      const double t = t0 + h * n / kSamples;
      const auto now = map.on_segment(segment, t);
      look_at_knots(map, segment, t, h / kSamples, before, now);
      look(now);
      before = now;
    }
  }
  /// By which factor time must be longer.
  double scale() const { return std::max({most_[0], std::sqrt(most_[1]), std::cbrt(most_[2])}); }

 private:
  void look(const TimeMap::Derivatives& c) {
    if (c[0] < 0 || c[0] > spline_.duration()) return;  // Cut off: it waits.
    look(c, spline_.segment_at(c[0]));
  }
  /// Between samples at t - h and t: c passes the knot about where the chord does.
  void look_at_knots(const TimeMap& map, int segment, double t, double h,
                     const TimeMap::Derivatives& before, const TimeMap::Derivatives& now) {
    const auto& knots = spline_.knots();
    const double low = std::min(before[0], now[0]), high = std::max(before[0], now[0]);
    auto k = std::ranges::upper_bound(knots, low) - knots.begin();
    for (; k < std::ssize(knots) && knots[static_cast<std::size_t>(k)] < high; ++k) {
      const double knot = knots[static_cast<std::size_t>(k)];
      double at = t - h * (now[0] - knot) / (now[0] - before[0]);
      const auto near = map.on_segment(segment, at);
      const double newton = at - (near[0] - knot) / near[1];
      if (newton > t - h && newton < t) at = newton;
      auto c = map.on_segment(segment, at);
      c[0] = knot;
      if (k > 0) look(c, static_cast<int>(k) - 1);
      if (k + 1 < std::ssize(knots)) look(c, static_cast<int>(k));
    }
  }
  /// By the chain rule.
  void look(const TimeMap::Derivatives& c, int k) {
    const auto at = static_cast<std::size_t>(k);
    const auto& q = spline_.segments()[at];
    const double s = c[0] - spline_.knots()[at];
    const double cc = c[1] * c[1], c12 = 3 * c[1] * c[2], ccc = cc * c[1];
    for (Index j = 0; j < q.rows(); ++j) {
      const double q3 = 6 * q(j, 3), q2 = 2 * q(j, 2) + s * q3;
      const double q1 = q(j, 1) + s * (2 * q(j, 2) + 0.5 * s * q3);
      const double derivatives[] = {q1 * c[1], q2 * cc + q1 * c[2],
                                    q3 * ccc + q2 * c12 + q1 * c[3]};
      for (int order = 0; order < 3; ++order) {
        most_[order] = std::max(most_[order], std::abs(derivatives[order]) * slowness_(j, order));
      }
    }
  }

  const motion::PiecewiseCubic& spline_;
  const Slowness slowness_;
  double most_[3] = {};  ///< Of velocities, accelerations and jerks, in parts of their limits.
};

}  // namespace

ScheduleTiming::ScheduleTiming(const std::vector<ArmMotion>& arms,
                               const std::vector<robot::JointLimits>& limits)
    : arms_(arms), limits_(limits) {
  std::size_t joints = 0;
  for (const ArmMotion& arm : arms_) joints += static_cast<std::size_t>(arm.dof());
  expects(joints == limits_.size(), "one limit per joint is needed");
  slowness_.resize(static_cast<Index>(joints), 3);
  for (Index j = 0; j < slowness_.rows(); ++j) {
    const robot::JointLimits& limit = limits_[static_cast<std::size_t>(j)];
    slowness_.row(j) << 1 / limit.velocity, 1 / limit.acceleration, 1 / limit.jerk;
  }
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
VectorXd ScheduleTiming::local_scales(const std::vector<VectorXd>& places) const {
  VectorXd scales = VectorXd::Zero(static_cast<Index>(times_.size()) - 1);
  Index first = 0;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    const TimeMap map = map_through(places, static_cast<Index>(i), times_);
    const Index dof = arms_[i].dof();
    PeakSampler sampler(arms_[i].spline(), slowness_.middleRows(first, dof));
    Index k = 0;
    for (std::size_t segment = 0; segment < map.segments().size(); ++segment) {
      sampler.sample(map, static_cast<int>(segment));
      // A wait may span several intervals; then nothing moves.
      const double middle = 0.5 * (map.knots()[segment] + map.knots()[segment + 1]);
      while (k + 1 < scales.size() && times_[static_cast<std::size_t>(k) + 1] <= middle) ++k;
      scales[k] = std::max(scales[k], sampler.scale());
    }
    first += dof;
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

ScheduleTiming::Guess ScheduleTiming::guess(const std::vector<VectorXd>& places,
                                            VectorXd intervals) {
  expects(places.size() >= 2 && intervals.size() + 1 == static_cast<Index>(places.size()),
          "a schedule of N places has N - 1 intervals");
  constexpr int kRounds = 10;
  constexpr double kEven = 0.005;
  constexpr double kMost = 2;  ///< Of what an interval changes by in a round.
  intervals = intervals.cwiseMax(kShortest);
  Guess best{intervals};
  for (int round = 0; round <= kRounds; ++round) {
    times_ = summed(intervals);
    const VectorXd scales = local_scales(places);
    const double makespan = intervals.sum() * scales.maxCoeff();
    if (makespan < best.makespan) best = {intervals, makespan};
    // Where every interval is as near its limits as any other, another round gains nothing.
    if (scales.minCoeff() > (1 - kEven) * scales.maxCoeff()) break;
    intervals.array() *= scales.array().sqrt().max(1 / kMost).min(kMost);
    intervals = intervals.cwiseMax(kShortest);
  }
  return best;
}

std::vector<TimeMap> ScheduleTiming::fit(const std::vector<VectorXd>& places,
                                         const VectorXd& intervals) {
  interpolate(places, intervals);
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
