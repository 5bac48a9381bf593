#include "tandem/trajectory/piece_derivatives.h"

#include <algorithm>
#include <array>

#include "tandem/core/contract.h"

namespace tandem::trajectory {

using math::Bernstein;
using motion::ArmMotion;

namespace {

/// A small polynomial by its powers.
struct Powers {
  std::array<double, Bernstein::kMostDegree + 1> a{};
  std::size_t degree = 0;
};

Powers operator*(const Powers& p, const Powers& q) {
  Powers product;
  product.degree = p.degree + q.degree;
  for (std::size_t i = 0; i <= p.degree; ++i) {
    for (std::size_t k = 0; k <= q.degree; ++k) product.a[i + k] += p.a[i] * q.a[k];
  }
  return product;
}

Powers operator*(double factor, Powers p) {
  for (std::size_t i = 0; i <= p.degree; ++i) p.a[i] *= factor;
  return p;
}

Powers operator+(Powers p, const Powers& q) {
  p.degree = std::max(p.degree, q.degree);
  for (std::size_t i = 0; i <= q.degree; ++i) p.a[i] += q.a[i];
  return p;
}

/// By t, of a polynomial of u = t / h.
Powers derivative(const Powers& p, double h) {
  Powers d;
  d.degree = p.degree > 0 ? p.degree - 1 : 0;
  for (std::size_t i = 1; i <= p.degree; ++i) d.a[i - 1] = static_cast<double>(i) * p.a[i] / h;
  return d;
}

/// Local time beyond `origin` over the piece.
Powers local_time(const ArmMotion& motion, const ArmMotion::Piece& piece, double origin) {
  const double h = piece.t1 - piece.t0;
  Powers s;
  s.degree = 1;
  if (piece.map < 0) {
    s.a[0] = piece.t0 - origin;
    s.a[1] = h;
    return s;
  }
  const auto k = static_cast<std::size_t>(piece.map);
  const motion::TimeMap::Segment& c = motion.map()->segments()[k];
  for (std::size_t i = 0; i < c.size(); ++i) {
    s.a[i] = c[i];
    if (c[i] != 0) s.degree = std::max(s.degree, i);
  }
  // Taylor shift from the map's knot to the piece, then the scale.
  const double shift = piece.t0 - motion.map()->knots()[k];
  for (std::size_t i = 0; i < s.degree; ++i) {
    for (std::size_t n = s.degree; n-- > i;) s.a[n] += shift * s.a[n + 1];
  }
  s.a[0] -= origin;
  double power = 1;
  for (std::size_t i = 1; i <= s.degree; ++i) s.a[i] *= power *= h;
  return s;
}

}  // namespace

PieceDerivatives::PieceDerivatives(const ArmMotion& motion, const ArmMotion::Piece& piece)
    : spline_(motion.spline()), segment_(piece.spline) {
  if (segment_ < 0) return;
  const double h = piece.t1 - piece.t0;
  const Powers s = local_time(motion, piece, spline_.knots()[static_cast<std::size_t>(segment_)]);
  const Powers c1 = derivative(s, h), c2 = derivative(c1, h), c3 = derivative(c2, h);
  const Powers ss = s * s, c11 = c1 * c1, c12 = c1 * c2;
  brackets_.reserve(9);
  const auto add = [&](std::size_t degree, std::initializer_list<Powers> brackets) {
    for (const Powers& bracket : brackets) {
      brackets_.emplace_back(std::span(bracket.a.data(), degree + 1));
    }
  };
  // Of each kind the highest degree; for a linear c some are less, and their last powers 0.
  const std::size_t n = 3 * s.degree;
  add(n - 1, {c1, s * c1, ss * c1});
  add(n - 2, {c2, c11 + s * c2, 2 * (s * c11) + ss * c2});
  add(n - 3, {c3, 3 * c12 + s * c3, 2 * (c1 * c11) + 6 * (s * c12) + ss * c3});
}

Bernstein PieceDerivatives::operator()(int order, Eigen::Index joint) const {
  expects(order >= 1 && order <= 3, "velocity, acceleration or jerk");
  if (segment_ < 0) return Bernstein(std::array{0.0});
  const auto q = spline_.segments()[static_cast<std::size_t>(segment_)].row(joint);
  const auto* bracket = &brackets_[static_cast<std::size_t>(3 * (order - 1))];
  return Bernstein::combination(q[1], bracket[0], 2 * q[2], bracket[1], 3 * q[3], bracket[2]);
}

}  // namespace tandem::trajectory
