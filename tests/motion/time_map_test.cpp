#include "tandem/motion/time_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "motion/random_motions.h"
#include "tandem/core/contract.h"

namespace tandem::motion {
namespace {

using Segment = TimeMap::Segment;

TEST(TimeMap, EvaluatesItsPolynomials) {
  const TimeMap map = *TimeMap::make({0, 1, 3}, {{{1, 2, 3, 4, 5, 6}}, {{7, -1}}});
  EXPECT_EQ(map.duration(), 3);
  const double s = 0.5;
  const TimeMap::Derivatives d = map.at(s);
  EXPECT_DOUBLE_EQ(d[0], 1 + 1 + 0.75 + 0.5 + 5.0 / 16 + 6.0 / 32);
  EXPECT_DOUBLE_EQ(d[1], 2 + 3 + 3 + 20.0 / 8 + 30.0 / 16);
  EXPECT_DOUBLE_EQ(d[2], 6 + 12 + 60.0 / 4 + 120.0 / 8);
  EXPECT_DOUBLE_EQ(d[3], 24 + 60 + 360.0 / 4);
  EXPECT_EQ(map(s), d[0]);
  EXPECT_EQ(map.at(1), (TimeMap::Derivatives{7, -1, 0, 0}));
  EXPECT_EQ(map.on_segment(0, 1)[0], 21);
  EXPECT_EQ(map.at(-1), (TimeMap::Derivatives{1, 0, 0, 0}));
  EXPECT_EQ(map.at(4), (TimeMap::Derivatives{5, 0, 0, 0}));
  EXPECT_EQ(map(4), 5);
}

TEST(TimeMap, DerivativesAgreeWithDifferences) {
  Rng rng(1);
  for (int i = 0; i < 300; ++i) {
    const TimeMap map = random_map(rng, 1, 2);
    const double h = 1e-5 * map.duration(), t = rng.uniform(0.1, 0.9) * map.duration();
    const auto d = map.at(t), before = map.at(t - h), after = map.at(t + h);
    for (std::size_t n = 0; n < 3; ++n) {
      const double scale = 100 * std::pow(map.duration(), -1.0 - static_cast<double>(n));
      EXPECT_NEAR(d[n + 1], (after[n] - before[n]) / (2 * h), 1e-6 * scale);
    }
  }
}

TEST(TimeMap, RangeIsExact) {
  Rng rng(2);
  for (int i = 0; i < 400; ++i) {
    const TimeMap map = random_map(rng, static_cast<int>(1 + rng.index(4)), 2);
    double t0 = rng.uniform(-0.1, 1) * map.duration(), t1 = rng.uniform(0, 1.1) * map.duration();
    if (t0 > t1) std::swap(t0, t1);
    const auto [least, largest] = map.range(t0, t1);
    double low = std::numeric_limits<double>::infinity(), high = -low, slope = 0;
    constexpr int kSamples = 2000;
    for (int k = 0; k <= kSamples; ++k) {
      const auto d = map.at(t0 + (t1 - t0) * k / kSamples);
      low = std::min(low, d[0]);
      high = std::max(high, d[0]);
      slope = std::max(slope, std::abs(d[2]));
    }
    for (std::size_t k = 1; k + 1 < map.knots().size(); ++k) {
      if (map.knots()[k] <= t0 || map.knots()[k] > t1) continue;
      const double end = map.on_segment(static_cast<int>(k) - 1, map.knots()[k])[0];
      low = std::min(low, end);
      high = std::max(high, end);
    }
    const double step = (t1 - t0) / kSamples;
    const double missed = 2 * slope * step * step + 1e-12;
    EXPECT_LE(least, low + 1e-12);
    EXPECT_GE(largest, high - 1e-12);
    EXPECT_GE(least, low - missed - 0.02 * (high - low));
    EXPECT_LE(largest, high + missed + 0.02 * (high - low));
    // What it names is reached: somewhere c is that low and that high.
    EXPECT_TRUE(least == low || least >= low - missed - 1e-2);
  }
  const TimeMap bump = *TimeMap::make({0, 2}, {{{0, 0, 4, -4, 1}}});  // t^2 (2 - t)^2
  EXPECT_EQ(bump.range(0, 2).first, 0);
  EXPECT_DOUBLE_EQ(bump.range(0, 2).second, 1);
  EXPECT_DOUBLE_EQ(bump.range(0.5, 2).second, 1);
  EXPECT_LT(bump.range(0, 0.5).second, 0.6);
}

TEST(TimeMap, CrossingsAreWhereItHasTheValue) {
  Rng rng(3);
  int found = 0;
  for (int i = 0; i < 400; ++i) {
    const TimeMap map = random_map(rng, 2, 2);
    const double local = rng.uniform(0, 2);
    for (int k = 0; k < 2; ++k) {
      const std::vector<double> times = map.crossings(k, local);
      int changes = 0;
      const auto begin = map.knots()[static_cast<std::size_t>(k)];
      const auto end = map.knots()[static_cast<std::size_t>(k) + 1];
      constexpr int kSamples = 500;
      for (int s = 0; s < kSamples; ++s) {
        const double a = begin + (end - begin) * s / kSamples;
        const double b = begin + (end - begin) * (s + 1) / kSamples;
        const bool crosses = (map.on_segment(k, a)[0] < local) != (map.on_segment(k, b)[0] < local);
        changes += crosses;
        if (!crosses) continue;
        EXPECT_TRUE(
            std::ranges::any_of(times, [&](double t) { return t >= a - 1e-9 && t <= b + 1e-9; }));
      }
      EXPECT_GE(static_cast<int>(times.size()), changes);
      for (const double t : times) {
        EXPECT_GE(t, begin);
        EXPECT_LE(t, end);
        EXPECT_NEAR(map.on_segment(k, t)[0], local, 1e-9);
      }
      found += static_cast<int>(times.size());
    }
  }
  EXPECT_GT(found, 200);
}

TEST(TimeMap, StretchingSlowsIt) {
  Rng rng(4);
  const TimeMap map = random_map(rng, 3, 2), slow = map.stretched(3);
  EXPECT_DOUBLE_EQ(slow.duration(), 3 * map.duration());
  for (int i = 0; i < 50; ++i) {
    const double t = rng.uniform(0, map.duration());
    const auto d = map.at(t), s = slow.at(3 * t);
    for (std::size_t n = 0; n < 4; ++n) {
      const double expected = d[n] / std::pow(3, static_cast<double>(n));
      EXPECT_NEAR(s[n], expected, 1e-9 * (1 + std::abs(expected)));
    }
  }
  EXPECT_THROW(map.stretched(0), ContractViolation);
}

TEST(TimeMap, RefusesMalformedInputAndSaysWhere) {
  const auto message = [](std::vector<double> knots, std::vector<Segment> segments) {
    const auto map = TimeMap::make(std::move(knots), std::move(segments));
    EXPECT_FALSE(map);
    if (map) return std::string();
    EXPECT_EQ(map.error().code, ErrorCode::kInvalidInput);
    return map.error().message;
  };
  const auto says = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const double nan = std::nan("");
  EXPECT_TRUE(says(message({0}, {}), "at least 2 knots"));
  EXPECT_TRUE(says(message({0, 1}, {{}, {}}), "2 knots need 1 segments, there are 2"));
  EXPECT_TRUE(says(message({1, 2}, {{}}), "knot 0 must be 0"));
  EXPECT_TRUE(says(message({0, 2, 2}, {{}, {}}), "knot 2 (2.000000)"));
  EXPECT_TRUE(says(message({0, nan}, {{}}), "knot 1 (nan)"));
  EXPECT_TRUE(says(message({0, 1}, {{{0, nan}}}), "coefficient c1 of segment 0 (nan)"));
}

}  // namespace
}  // namespace tandem::motion
