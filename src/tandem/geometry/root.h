#pragma once
/// Zero of an increasing function of one variable.

#include <cmath>

namespace tandem::geometry::detail {

/// A function's value and derivative.
struct Slope {
  double value, derivative;
};

/// The zero of `f` in [low, high], where f(low) <= 0 <= f(high) and f never decreases: Newton's
/// method, and bisection where that leaves the bracket or is slow.
/// @param f   double -> Slope.
template <class Function>
double increasing_root(double low, double high, const Function& f) {
  constexpr int kSteps = 100;           // Bisection alone needs fewer for all 53 bits.
  constexpr double kConverged = 4e-16;  // [-] of the argument.
  double x = 0.5 * (low + high), last = high - low, before_last = last;
  for (int i = 0; i < kSteps; ++i) {
    const Slope at_x = f(x);
    if (at_x.value == 0) return x;
    (at_x.value < 0 ? low : high) = x;
    double next = x - at_x.value / at_x.derivative;
    // Also refuses the NaN of a vanishing derivative.
    if (!(next > low && next < high && std::abs(next - x) < 0.5 * before_last)) {
      next = 0.5 * (low + high);
    }
    before_last = last;
    last = std::abs(next - x);
    x = next;
    if (last <= kConverged * std::abs(x) || last < 1e-300) break;
  }
  return x;
}

}  // namespace tandem::geometry::detail
