#include "tandem/coordination/interpolation.h"

#include <Eigen/LU>

#include "tandem/core/contract.h"
#include "tandem/math/tridiagonal.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;
using motion::TimeMap;
using Segment = TimeMap::Segment;

namespace {

VectorXd intervals(const std::vector<double>& times) {
  VectorXd h(static_cast<Index>(times.size()) - 1);
  for (Index k = 0; k < h.size(); ++k) {
    h[k] = times[static_cast<std::size_t>(k) + 1] - times[static_cast<std::size_t>(k)];
  }
  return h;
}

std::vector<Segment> linear(const VectorXd& h, const VectorXd& c) {
  std::vector<Segment> segments;
  for (Index k = 0; k < h.size(); ++k) segments.push_back({c[k], (c[k + 1] - c[k]) / h[k]});
  return segments;
}

/// The natural spline: h_{k-1} a_{k-1} + 2 (h_{k-1} + h_k) a_k + h_k a_{k+1} = 6 times the change
/// of the slope of the chords, a = 0 at both ends.
std::vector<Segment> cubic(const VectorXd& h, const VectorXd& c) {
  const Index m = h.size(), n = m - 1;
  VectorXd a = VectorXd::Zero(m + 1);
  if (n > 0) {
    const VectorXd slope = (c.tail(m) - c.head(m)).cwiseQuotient(h);
    math::RowMatrix rhs = 6 * (slope.tail(n) - slope.head(n));
    const math::TridiagonalLu factors(h.segment(1, n - 1), 2 * (h.head(n) + h.tail(n)),
                                      h.segment(1, n - 1));
    factors.solve_in_place(rhs);  // Diagonally dominant: never singular.
    a.segment(1, n) = rhs;
  }
  std::vector<Segment> segments;
  for (Index k = 0; k < m; ++k) {
    segments.push_back({c[k], (c[k + 1] - c[k]) / h[k] - h[k] / 6 * (2 * a[k] + a[k + 1]), a[k] / 2,
                        (a[k + 1] - a[k]) / (6 * h[k])});
  }
  return segments;
}

/// Velocities v and accelerations a of all knots from the continuity of the third and fourth
/// derivative at the inner ones. On an interval with D = c_{k+1} - c_k the third is
/// (60 D - (36 v_0 + 24 v_1) h - (9 a_0 - 3 a_1) h^2) / h^3 at its begin, the fourth there
/// (-360 D + (192 v_0 + 168 v_1) h + (36 a_0 - 24 a_1) h^2) / h^4, and at its end the same seen in
/// a mirror.
std::vector<Segment> quintic(const VectorXd& h, const VectorXd& c) {
  const Index m = h.size(), n = m - 1;
  VectorXd v = VectorXd::Zero(m + 1), a = v;
  if (n > 0) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    VectorXd b = VectorXd::Zero(2 * n);
    for (Index k = 1; k <= n; ++k) {
      const Index third = 2 * (k - 1), fourth = third + 1;
      // Rows are scaled so that velocities and accelerations have entries of one size.
      const auto add = [&](Index row, Index knot, double by_v, double by_a) {
        if (knot < 1 || knot > n) return;
        A(row, 2 * (knot - 1)) += by_v;
        A(row, 2 * (knot - 1) + 1) += by_a;
      };
      const double before = h[k - 1], after = h[k], scale = std::min(before, after);
      const double third_before = std::pow(scale / before, 3),
                   third_after = std::pow(scale / after, 3);
      const double fourth_before = third_before * scale / before;
      const double fourth_after = third_after * scale / after;
      add(third, k - 1, third_before * -24 * before, third_before * -3 * before * before);
      add(third, k, third_before * -36 * before + third_after * 36 * after,
          third_before * 9 * before * before + third_after * 9 * after * after);
      add(third, k + 1, third_after * 24 * after, third_after * -3 * after * after);
      add(fourth, k - 1, fourth_before * -168 * before, fourth_before * -24 * before * before);
      add(fourth, k, fourth_before * -192 * before - fourth_after * 192 * after,
          fourth_before * 36 * before * before - fourth_after * 36 * after * after);
      add(fourth, k + 1, fourth_after * -168 * after, fourth_after * 24 * after * after);
      const double D = c[k] - c[k - 1], D_after = c[k + 1] - c[k];
      b[third] = 60 * (third_after * D_after - third_before * D);
      b[fourth] = -360 * (fourth_after * D_after + fourth_before * D);
    }
    const VectorXd x = A.partialPivLu().solve(b);
    for (Index k = 1; k <= n; ++k) {
      v[k] = x[2 * (k - 1)];
      a[k] = x[2 * (k - 1) + 1];
    }
  }
  std::vector<Segment> segments;
  for (Index k = 0; k < m; ++k) {
    const double D = c[k + 1] - c[k], s = h[k];
    segments.push_back(
        {c[k], v[k], a[k] / 2,
         (20 * D - (8 * v[k + 1] + 12 * v[k]) * s - (3 * a[k] - a[k + 1]) * s * s) /
             (2 * s * s * s),
         (-30 * D + (14 * v[k + 1] + 16 * v[k]) * s + (3 * a[k] - 2 * a[k + 1]) * s * s) /
             (2 * s * s * s * s),
         (12 * D - 6 * (v[k + 1] + v[k]) * s - (a[k] - a[k + 1]) * s * s) /
             (2 * s * s * s * s * s)});
  }
  return segments;
}

}  // namespace

const char* to_string(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kLinear:
      return "linear";
    case Interpolation::kCubic:
      return "cubic";
    case Interpolation::kQuintic:
      return "quintic";
  }
  return "unknown";
}

TimeMap interpolate(const std::vector<double>& times, const VectorXd& values,
                    Interpolation interpolation) {
  expects(times.size() >= 2 && values.size() == static_cast<Index>(times.size()),
          "an interpolation needs two places or more, each with a time");
  const VectorXd h = intervals(times);
  expects((h.array() > 0).all(), "the times of a schedule increase");
  std::vector<Segment> segments;
  switch (interpolation) {
    case Interpolation::kLinear:
      segments = linear(h, values);
      break;
    case Interpolation::kCubic:
      segments = cubic(h, values);
      break;
    case Interpolation::kQuintic:
      segments = quintic(h, values);
      break;
  }
  auto map = TimeMap::make(times, std::move(segments));
  expects(map.has_value(), "places and times are finite, and no interval next to nothing");
  return *std::move(map);
}

std::vector<TimeMap> interpolate(const Schedule& schedule, Interpolation interpolation) {
  expects(schedule.places.size() >= 2 && schedule.places.size() == schedule.times.size(),
          "a schedule has a time for each place");
  std::vector<TimeMap> maps;
  for (Index arm = 0; arm < schedule.places.front().size(); ++arm) {
    VectorXd values(static_cast<Index>(schedule.places.size()));
    for (Index k = 0; k < values.size(); ++k) {
      const VectorXd& place = schedule.places[static_cast<std::size_t>(k)];
      expects(place.size() == schedule.places.front().size(), "places have one time per arm");
      values[k] = place[arm];
    }
    maps.push_back(interpolate(schedule.times, values, interpolation));
  }
  return maps;
}

}  // namespace tandem::coordination
