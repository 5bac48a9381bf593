#include "tandem/math/bernstein.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/core/contract.h"

namespace tandem::math {

namespace {

constexpr auto kSize = static_cast<std::size_t>(Bernstein::kMostDegree) + 1;

/// Row n: C(n, 0) .. C(n, n).
constexpr auto kBinomials = [] {
  std::array<std::array<double, kSize>, kSize> c{};
  for (std::size_t n = 0; n < kSize; ++n) {
    c[n][0] = 1;
    for (std::size_t k = 1; k <= n; ++k) c[n][k] = c[n - 1][k - 1] + c[n - 1][k];
  }
  return c;
}();

/// Row n, k, i: C(i, k) / C(n, k), what the power u^k gives to coefficient i of degree n.
constexpr auto kFromPowers = [] {
  std::array<std::array<std::array<double, kSize>, kSize>, kSize> m{};
  for (std::size_t n = 0; n < kSize; ++n) {
    for (std::size_t k = 0; k <= n; ++k) {
      for (std::size_t i = k; i <= n; ++i) m[n][k][i] = kBinomials[i][k] / kBinomials[n][k];
    }
  }
  return m;
}();

/// A part of [0, 1] and the polynomial on it.
struct Part {
  Bernstein p;
  double from, to;
};

/// Between two ends with opposite signs: regula falsi that halves the weight of an end which stays
/// (Illinois), which needs no slope and never leaves the bracket.
double bracketed_root(const Bernstein& p) {
  double low = 0, high = 1, at_low = p.front(), at_high = p.back();
  int side = 0;
  constexpr int kSteps = 100;
  for (int i = 0; i < kSteps && high - low > std::numeric_limits<double>::epsilon(); ++i) {
    const double guess = (low * at_high - high * at_low) / (at_high - at_low);
    const double u = guess > low && guess < high ? guess : 0.5 * (low + high);
    if (!(u > low && u < high)) break;
    const double value = p(u);
    if (value == 0) return u;
    if ((value < 0) == (at_low < 0)) {
      low = u;
      at_low = value;
      if (side == -1) at_high *= 0.5;
      side = -1;
    } else {
      high = u;
      at_high = value;
      if (side == 1) at_low *= 0.5;
      side = 1;
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

Bernstein::Bernstein(std::span<const double> powers) {
  expects(!powers.empty() && powers.size() <= kSize, "a polynomial of degree 0 to 15");
  const std::size_t n = powers.size() - 1;
  degree_ = static_cast<int>(n);
  for (std::size_t k = 0; k <= n; ++k) {
    for (std::size_t i = k; i <= n; ++i) b_[i] += kFromPowers[n][k][i] * powers[k];
  }
}

Bernstein Bernstein::combination(double a, const Bernstein& p, double b, const Bernstein& q,
                                 double c, const Bernstein& r) {
  expects(p.degree_ == q.degree_ && q.degree_ == r.degree_, "polynomials of one degree");
  Bernstein sum;
  sum.degree_ = p.degree_;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(p.degree_); ++i) {
    sum.b_[i] = a * p.b_[i] + b * q.b_[i] + c * r.b_[i];
  }
  return sum;
}

double Bernstein::operator()(double u) const {
  std::array<double, kSize> b = b_;
  for (int n = degree_; n > 0; --n) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) b[i] += u * (b[i + 1] - b[i]);
  }
  return b[0];
}

double Bernstein::lower() const { return *std::min_element(b_.begin(), b_.begin() + degree_ + 1); }
double Bernstein::upper() const { return *std::max_element(b_.begin(), b_.begin() + degree_ + 1); }
double Bernstein::magnitude() const {
  double most = 0;
  for (int i = 0; i <= degree_; ++i)
    most = std::max(most, std::abs(b_[static_cast<std::size_t>(i)]));
  return most;
}

int Bernstein::variations() const {
  int changes = 0;
  double last = 0;
  for (int i = 0; i <= degree_; ++i) {
    const double b = b_[static_cast<std::size_t>(i)];
    if (b == 0) continue;
    if (last != 0 && (b < 0) != (last < 0)) ++changes;
    last = b;
  }
  return changes;
}

std::pair<Bernstein, Bernstein> Bernstein::halves() const {
  std::pair<Bernstein, Bernstein> both(*this, *this);
  std::array<double, kSize>& b = both.second.b_;
  for (int n = degree_; n >= 0; --n) {
    both.first.b_[static_cast<std::size_t>(degree_ - n)] = b[0];
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) b[i] = 0.5 * (b[i] + b[i + 1]);
  }
  return both;
}

std::vector<double> roots(const Bernstein& p) {
  constexpr double kNarrowest = 1e-12;
  std::vector<double> found;
  const auto note = [&](double u) {
    if (found.empty() || u > found.back()) found.push_back(u);
  };
  if (p.magnitude() == 0) return found;
  std::vector<Part> open{{p, 0, 1}};
  while (!open.empty()) {
    const Part part = open.back();
    open.pop_back();
    const int variations = part.p.variations();
    if (part.p.front() == 0) note(part.from);
    if (variations == 1 && part.p.front() != 0 && part.p.back() != 0) {
      note(part.from + (part.to - part.from) * bracketed_root(part.p));
    } else if (variations > 0 && part.to - part.from < kNarrowest) {
      note(0.5 * (part.from + part.to));
    } else if (variations > 0) {
      const double middle = 0.5 * (part.from + part.to);
      const auto [first, second] = part.p.halves();
      open.push_back({second, middle, part.to});
      open.push_back({first, part.from, middle});
      continue;
    }
    if (part.p.back() == 0) note(part.to);
  }
  return found;
}

double largest_magnitude(const Bernstein& p, double known, double tolerance) {
  double best = std::max({known, std::abs(p.front()), std::abs(p.back())});
  const auto is_done = [&](const Bernstein& part) {
    // The last term ends what is next to zero everywhere.
    return part.magnitude() <= best * (1 + tolerance) + std::numeric_limits<double>::min();
  };
  if (is_done(p)) return best;
  // A half is at most 2^-52 wide when its ends differ by rounding alone, which ends any descent.
  constexpr int kMostHalvings = 52;
  std::vector<std::pair<Bernstein, int>> open{{p, 0}};
  while (!open.empty()) {
    const auto [part, depth] = open.back();
    open.pop_back();
    if (is_done(part) || depth == kMostHalvings) continue;
    const auto [first, second] = part.halves();
    best = std::max({best, std::abs(second.front()), std::abs(second.back())});
    const bool first_is_larger = first.magnitude() > second.magnitude();
    open.emplace_back(first_is_larger ? second : first, depth + 1);
    open.emplace_back(first_is_larger ? first : second, depth + 1);
  }
  return best;
}

}  // namespace tandem::math
