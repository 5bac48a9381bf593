#include "tandem/motion/time_map.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tandem/core/contract.h"
#include "tandem/math/bernstein.h"
#include "tandem/motion/knots.h"
#include "tandem/motion/piecewise_cubic.h"

namespace tandem::motion {

namespace {

using Segment = TimeMap::Segment;

double value(const Segment& c, double s) {
  return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
}

/// Coefficients of the slope by u, for s = from + (to - from) u: the same roots in [0, 1].
std::array<double, TimeMap::kDegree> slope_over(const Segment& c, double from, double to) {
  std::array<double, TimeMap::kDegree> a{};
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = static_cast<double>(i + 1) * c[i + 1];
  // Taylor shift by Horner's scheme, then the scale.
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    for (std::size_t k = a.size() - 1; k-- > i;) a[k] += from * a[k + 1];
  }
  double power = 1;
  for (double& coefficient : a) {
    coefficient *= power;
    power *= to - from;
  }
  return a;
}

/// Widens [least, largest] by the values where the slope vanishes inside (from, to).
void visit_stationary(const Segment& c, double from, double to, double& least, double& largest) {
  const auto visit = [&](double s) {
    if (!(s > from && s < to)) return;
    const double v = value(c, s);
    least = std::min(least, v);
    largest = std::max(largest, v);
  };
  if (c[4] == 0 && c[5] == 0) {
    const StationaryPoints points = stationary_points(c[1], c[2], c[3]);
    for (int i = 0; i < points.count; ++i) visit(points.s[i]);
    return;
  }
  for (const double u : math::roots(math::Bernstein(slope_over(c, from, to)))) {
    visit(from + (to - from) * u);
  }
}

}  // namespace

Result<TimeMap> TimeMap::make(std::vector<double> knots, std::vector<Segment> segments) {
  const auto invalid = [](const std::string& what) {
    return fail(ErrorCode::kInvalidInput, "time map: " + what);
  };
  if (auto valid = check_knots(knots, segments.size()); !valid) {
    return invalid(valid.error().message);
  }
  for (std::size_t k = 0; k < segments.size(); ++k) {
    for (std::size_t i = 0; i < segments[k].size(); ++i) {
      if (std::isfinite(segments[k][i])) continue;
      return invalid("coefficient c" + std::to_string(i) + " of segment " + std::to_string(k) +
                     " (" + std::to_string(segments[k][i]) + ") must be finite");
    }
  }
  return TimeMap(std::move(knots), std::move(segments));
}

int TimeMap::segment_at(double t) const { return motion::segment_at(knots_, t); }

TimeMap::Derivatives TimeMap::on_segment(int k, double t) const {
  const Segment& c = segments_[static_cast<std::size_t>(k)];
  const double s = t - knots_[static_cast<std::size_t>(k)];
  return {value(c, s), c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * 5 * c[5]))),
          2 * c[2] + s * (6 * c[3] + s * (12 * c[4] + s * 20 * c[5])),
          6 * c[3] + s * (24 * c[4] + s * 60 * c[5])};
}

TimeMap::Derivatives TimeMap::at(double t) const {
  const double clamped = std::clamp(t, 0.0, duration());
  const Derivatives d = on_segment(segment_at(clamped), clamped);
  return t < 0 || t > duration() ? Derivatives{d[0], 0, 0, 0} : d;
}

double TimeMap::operator()(double t) const {
  const double clamped = std::clamp(t, 0.0, duration());
  const auto k = static_cast<std::size_t>(segment_at(clamped));
  return value(segments_[k], clamped - knots_[k]);
}

std::pair<double, double> TimeMap::range(double t0, double t1) const {
  const double from = std::clamp(t0, 0.0, duration()), to = std::clamp(t1, 0.0, duration());
  double least = (*this)(from), largest = least;
  const auto last = static_cast<std::size_t>(segment_at(to));
  for (auto k = static_cast<std::size_t>(segment_at(from)); k <= last; ++k) {
    const double low = std::max(from, knots_[k]) - knots_[k];
    const double high = std::min(to, knots_[k + 1]) - knots_[k];
    for (const double s : {low, high}) {
      const double v = value(segments_[k], s);
      least = std::min(least, v);
      largest = std::max(largest, v);
    }
    visit_stationary(segments_[k], low, high, least, largest);
  }
  return {least, largest};
}

std::vector<double> TimeMap::crossings(int k, double local) const {
  const auto segment = static_cast<std::size_t>(k);
  expects(k >= 0 && segment < segments_.size(), "a segment of the time map");
  const double begin = knots_[segment], end = knots_[segment + 1];
  Segment scaled = segments_[segment];
  scaled[0] -= local;
  double power = 1;
  for (double& coefficient : scaled) {
    coefficient *= power;
    power *= end - begin;
  }
  std::vector<double> times = math::roots(math::Bernstein(scaled));
  for (double& t : times) t = t == 1 ? end : begin + (end - begin) * t;
  return times;
}

TimeMap TimeMap::stretched(double factor) const {
  expects(factor > 0 && std::isfinite(factor), "a stretch factor must be positive and finite");
  TimeMap slower = *this;
  for (double& knot : slower.knots_) knot *= factor;
  for (Segment& segment : slower.segments_) {
    double power = 1;
    for (double& coefficient : segment) {
      coefficient /= power;
      power *= factor;
    }
  }
  return slower;
}

}  // namespace tandem::motion
