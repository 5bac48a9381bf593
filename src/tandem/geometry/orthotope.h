#pragma once
/// Nearest points of a point or a segment and an orthotope: a point, segment, rectangle or box.

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/geometry/shape.h"

namespace tandem::geometry::detail {

/// A pair of core points. Their difference is kept too: it is more exact than what is left of it
/// in the positions.
struct Nearest {
  Eigen::Vector3d p_WCb = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_BA_W = Eigen::Vector3d::Zero();     ///< From there to the point of A.
  double squared = std::numeric_limits<double>::max();  ///< [m^2] of p_BA_W.

  Eigen::Vector3d point_of_a() const { return p_WCb + p_BA_W; }
  Nearest swapped() const { return {point_of_a(), -p_BA_W, squared}; }
};

/// Of two pairs the nearer one.
inline void keep_nearer(Nearest& best, const Nearest& other) {
  if (other.squared < best.squared) best = other;
}

/// Whether no pair can be nearer but for rounding: the cores touch there.
inline bool is_touch(const Nearest& nearest) {
  constexpr double kTouch = 1e-28;  // [m^2]
  return nearest.squared < kTouch;
}

/// A segment {c + t u, |t| <= 1}, all in W.
struct Segment {
  Eigen::Vector3d c, u;
  double inverse_square = 0;  ///< 1 / |u|^2, or 0 where u is zero; only read of a second segment.
};

/// Nearest points of point `p` (as A) and the orthotope core of `b` with N extents.
template <int N>
Nearest nearest_point_orthotope(const Eigen::Vector3d& p, const Shape& b) {
  const Eigen::Vector3d r = p - b.origin();
  Eigen::Vector3d e = r;
  for (int i = 0; i < N; ++i) {
    const auto u = b.extents().col(i);
    e -= std::clamp(b.inverse_squares()[i] * u.dot(r), -1.0, 1.0) * u;
  }
  return {p - e, e, e.squaredNorm()};
}

/// The parameter t in [-1, 1] of the point of {r + t d} nearest to the orthotope with N extents
/// (columns of `u`) about the origin.
///
/// The squared distance is convex and piecewise quadratic in t, with breaks only where the line
/// crosses the planes that bound the orthotope's slabs. Its derivative is bracketed between breaks,
/// where it is linear: exact, and indifferent to parallel, touching and zero-length input.
template <int N, class Columns>
double nearest_parameter(const Eigen::Vector3d& r, const Eigen::Vector3d& d, const Columns& u,
                         const double* inverse_squares) {
  constexpr double kRounding = 1e-15;  // [-] of a coordinate; several roundings.
  double alpha[N + 1], beta[N + 1], kappa[N + 1];
  // Slabs a rounding wider: inside, and on the breaks, a coordinate adds exactly nothing, else its
  // noise would outweigh small true terms.
  double limit[N + 1];
  Eigen::Vector3d r_out = r, d_out = d;  // What is normal to every extent.
  for (int i = 0; i < N; ++i) {
    kappa[i] = u.col(i).dot(d);
    alpha[i] = inverse_squares[i] * u.col(i).dot(r);
    beta[i] = inverse_squares[i] * kappa[i];
    limit[i] = 1 + kRounding * (1 + std::abs(alpha[i]) + std::abs(beta[i]));
    if (N < 3) {
      r_out -= alpha[i] * u.col(i);
      d_out -= beta[i] * u.col(i);
    }
  }
  const double offset = N < 3 ? r_out.dot(d_out) : 0.0, slope = N < 3 ? d_out.squaredNorm() : 0.0;
  const auto derivative = [&](double t) {
    double sum = offset + t * slope;
    for (int i = 0; i < N; ++i) {
      const double s = alpha[i] + t * beta[i];
      sum += kappa[i] * (s - std::min(std::max(s, -limit[i]), limit[i]));
    }
    return sum;
  };
  double low = -1, high = 1;
  double at_low = derivative(low), at_high = derivative(high);
  if (at_low >= 0) return low;
  if (at_high <= 0) return high;
  for (int i = 0; i < N; ++i) {
    const double inverse = 1 / beta[i];  // Infinite where parallel: then no break is inside.
    for (const double side : {-1.0, 1.0}) {
      const double t = (side - alpha[i]) * inverse;
      if (!(t > low && t < high)) continue;
      const double at_t = derivative(t);
      (at_t < 0 ? low : high) = t;
      (at_t < 0 ? at_low : at_high) = at_t;
    }
  }
  return low - at_low * (high - low) / (at_high - at_low);
}

/// Nearest points of the orthotope (columns of `u` about `c`, N of them) and a segment (as A).
template <int N, class Columns>
Nearest nearest_segment_orthotope(const Segment& a, const Eigen::Vector3d& c, const Columns& u,
                                  const double* inverse_squares) {
  const Eigen::Vector3d r = a.c - c;
  const double t = nearest_parameter<N>(r, a.u, u, inverse_squares);
  const Eigen::Vector3d q = r + t * a.u;
  Eigen::Vector3d e = q;
  for (int i = 0; i < N; ++i) {
    e -= std::clamp(inverse_squares[i] * u.col(i).dot(q), -1.0, 1.0) * u.col(i);
  }
  return {c + (q - e), e, e.squaredNorm()};
}

template <int N>
Nearest nearest_segment_orthotope(const Segment& a, const Shape& b) {
  return nearest_segment_orthotope<N>(a, b.origin(), b.extents(), b.inverse_squares().data());
}

}  // namespace tandem::geometry::detail
