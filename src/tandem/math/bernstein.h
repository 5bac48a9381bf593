#pragma once
/// Polynomials on [0, 1] in Bernstein form: bounds, roots and peaks that cannot be missed.

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace tandem::math {

/// p(u) for u in [0, 1]. Its coefficients enclose its values, and those of its halves enclose them
/// more closely by the square of the width: so what a subdivision rules out is ruled out.
class Bernstein {
 public:
  static constexpr int kMostDegree = 15;

  /// @param powers  a_0 + a_1 u + a_2 u^2 + ..., 1 to kMostDegree + 1 of them.
  explicit Bernstein(std::span<const double> powers);

  /// a p + b q + c r, of one degree.
  static Bernstein combination(double a, const Bernstein& p, double b, const Bernstein& q, double c,
                               const Bernstein& r);

  int degree() const { return degree_; }
  double operator()(double u) const;
  double front() const { return b_[0]; }                                 ///< p(0)
  double back() const { return b_[static_cast<std::size_t>(degree_)]; }  ///< p(1)
  double lower() const;                                                  ///< Below all values.
  double upper() const;                                                  ///< Above all values.
  double magnitude() const;                                              ///< Above all |values|.
  /// Sign changes of the coefficients, zeros ignored: at least the number of roots in (0, 1).
  int variations() const;
  /// The same polynomial on [0, 1/2] and on [1/2, 1], each over [0, 1].
  std::pair<Bernstein, Bernstein> halves() const;

 private:
  Bernstein() = default;

  std::array<double, kMostDegree + 1> b_{};
  int degree_ = 0;
};

/// Where p vanishes in [0, 1], ascending, to rounding. Where p only touches zero, or passes it
/// twice by rounding, there may be a root or none; the zero polynomial has none.
std::vector<double> roots(const Bernstein& p);

/// The larger of `known` and max |p|, found to `tolerance` [-]: what is returned is `known` or a
/// value of |p|, and |p| exceeds it nowhere by more than that fraction of it.
double largest_magnitude(const Bernstein& p, double known, double tolerance = 1e-9);

}  // namespace tandem::math
