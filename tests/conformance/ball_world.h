#pragma once
/// Worlds of balls in joint space: what planners are tried on without a robot.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <thread>

#include "tandem/core/rng.h"
#include "tandem/planning/planner.h"

namespace tandem::planning {

namespace conformance {

using Eigen::VectorXd;
using motion::JointPath;

/// Balls in joint space. Edges are judged exactly: a part of a valid edge is valid.
struct BallWorld {
  std::vector<VectorXd> centres;
  double radius = 0;
  PathProblem problem;

  double clearance(const VectorXd& q) const {
    double least = std::numeric_limits<double>::infinity();
    for (const VectorXd& c : centres) least = std::min(least, (q - c).norm() - radius);
    return least;
  }
  double clearance(const VectorXd& a, const VectorXd& b) const {
    double least = std::numeric_limits<double>::infinity();
    const VectorXd d = b - a;
    for (const VectorXd& c : centres) {
      const double s =
          d.squaredNorm() > 0 ? std::clamp(d.dot(c - a) / d.squaredNorm(), 0.0, 1.0) : 0;
      least = std::min(least, (a + s * d - c).norm() - radius);
    }
    return least;
  }
};

class BallValidity : public Validity {
 public:
  explicit BallValidity(const BallWorld& world, std::chrono::microseconds cost = {})
      : world_(world), cost_(cost) {}
  bool state(const VectorXd& q) override {
    ++stats_.states;
    return world_.clearance(q) > 0;
  }
  bool edge(const VectorXd& a, const VectorXd& b) override {
    ++stats_.edges;
    const auto end = Clock::now() + cost_;
    while (cost_.count() > 0 && Clock::now() < end) {
    }
    return world_.clearance(a, b) > 0;
  }
  const ValidityStats& stats() const override { return stats_; }

 private:
  const BallWorld& world_;
  std::chrono::microseconds cost_;
  ValidityStats stats_;
};

inline VectorXd vector2(double x, double y) { return Eigen::Vector2d(x, y); }

/// Two rooms with a wall between them and a door of 0.2 at the far end.
inline BallWorld door_world() {
  BallWorld world;
  world.radius = 0.1;
  for (int i = 0; i <= 44; ++i) world.centres.push_back(vector2(0, -2 + 0.08 * i));
  world.problem = {vector2(-1, -1), vector2(1.2, -0.7), vector2(-2, -2), vector2(2, 2)};
  return world;
}

/// Start and goal of two seven-joint arms with balls around the straight line between them.
inline BallWorld arms_world(std::uint64_t seed = 3) {
  constexpr int kDof = 14;
  Rng rng(seed);
  BallWorld world;
  world.radius = 1.2;
  const VectorXd limit = VectorXd::Constant(kDof, 2.8);
  world.problem = {VectorXd::Constant(kDof, -0.9), VectorXd::Constant(kDof, 0.8), -limit, limit};
  const auto& [start, goal, lower, upper] = world.problem;
  while (world.centres.size() < 60) {
    VectorXd c = start + rng.uniform() * (goal - start);
    for (double& x : c) x += rng.uniform(-0.6, 0.6);
    if ((c - start).norm() > 1.4 && (c - goal).norm() > 1.4) world.centres.push_back(c);
  }
  return world;
}

/// A goal walled in: there is no path.
inline BallWorld closed_world() {
  BallWorld world;
  world.radius = 0.1;
  for (int i = 0; i < 60; ++i) {
    const double angle = 2 * std::numbers::pi * i / 60;
    world.centres.push_back(vector2(1 + 0.5 * std::cos(angle), 0.5 * std::sin(angle)));
  }
  world.problem = {vector2(-1, 0), vector2(1, 0), vector2(-2, -2), vector2(2, 2)};
  return world;
}

inline bool same_bits(const VectorXd& a, const VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

inline bool same_bits(const JointPath& a, const JointPath& b) {
  return std::ranges::equal(a, b,
                            [](const VectorXd& p, const VectorXd& q) { return same_bits(p, q); });
}

inline void expect_good(const JointPath& path, const BallWorld& world) {
  ASSERT_GE(path.size(), 2u);
  EXPECT_TRUE(same_bits(path.front(), world.problem.start));
  EXPECT_TRUE(same_bits(path.back(), world.problem.goal));
  BallValidity validity(world);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_TRUE(validity.edge(path[i - 1], path[i])) << "edge " << i;
    EXPECT_GE((path[i] - path[i - 1]).norm(), kSameWaypoint) << "edge " << i;
    // Samples know nothing of how the world judges edges.
    for (int k = 0; k <= 200; ++k) {
      const VectorXd q = path[i - 1] + k / 200.0 * (path[i] - path[i - 1]);
      ASSERT_GT(world.clearance(q), -1e-12) << "edge " << i << " at " << k / 200.0;
    }
    EXPECT_TRUE((path[i].array() >= world.problem.lower.array() - 1e-12).all());
    EXPECT_TRUE((path[i].array() <= world.problem.upper.array() + 1e-12).all());
  }
}

/// Slow machines under load oversleep; a planner that looks at no clock does so by far more.
inline constexpr double kStopSlack = 0.06;  // [s]

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// fn(i) for i in [0, n), each on a thread of its own, at once.
inline void at_once(int n, const std::function<void(int)>& fn) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < n; ++i) threads.emplace_back([&fn, i] { fn(i); });
}

}  // namespace conformance

/// Names the cases of a suite.
template <class Case>
std::string case_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

}  // namespace tandem::planning
