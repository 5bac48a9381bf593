#pragma once
/// What every PathPlanner and every PathSimplifier must do. Include in one source per test program
/// and instantiate:
///   INSTANTIATE_TEST_SUITE_P(Mine, PathPlannerConformance,
///                            testing::Values(PlannerCase{"mine", [] { return make_mine(); }}));

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <thread>

#include "tandem/core/rng.h"
#include "tandem/planning/planner.h"

namespace tandem::planning {

inline void PrintTo(const PathProblem& problem, std::ostream* out) {
  *out << problem.start.transpose() << " -> " << problem.goal.transpose();
}

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

struct PlannerCase {
  std::string name;
  std::function<std::unique_ptr<PathPlanner>()> make;
};

inline void PrintTo(const PlannerCase& planner, std::ostream* out) { *out << planner.name; }

class PathPlannerConformance : public testing::TestWithParam<PlannerCase> {
 protected:
  Result<motion::JointPath> plan(const conformance::BallWorld& world, std::uint64_t seed,
                                 const StopCondition& stop = StopCondition::after(20)) const {
    conformance::BallValidity validity(world);
    return planner_->plan(world.problem, validity, seed, stop);
  }
  std::unique_ptr<PathPlanner> planner_ = GetParam().make();
};

TEST_P(PathPlannerConformance, PathsAreValidAndKeepTheirEnds) {
  for (const auto& world : {conformance::door_world(), conformance::arms_world()}) {
    ASSERT_LT(world.clearance(world.problem.start, world.problem.goal), 0) << "too easy";
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto path = plan(world, seed);
      ASSERT_TRUE(path) << path.error().message;
      conformance::expect_good(*path, world);
    }
  }
}

TEST_P(PathPlannerConformance, EqualSeedsGiveEqualPathsAndOthersDiffer) {
  for (const auto& world : {conformance::door_world(), conformance::arms_world()}) {
    motion::JointPath before;
    for (std::uint64_t seed : {1ull, 2ull, 3ull, 1ull << 40}) {
      const auto first = plan(world, seed), second = plan(world, seed);
      ASSERT_TRUE(first && second);
      EXPECT_TRUE(conformance::same_bits(*first, *second)) << "seed " << seed;
      EXPECT_FALSE(conformance::same_bits(*first, before)) << "seed " << seed;
      before = *first;
    }
  }
}

TEST_P(PathPlannerConformance, ThreadsDoNotChangePaths) {
  constexpr int kThreads = 4;
  const auto world = conformance::arms_world();
  std::vector<motion::JointPath> alone;
  for (int i = 0; i < kThreads; ++i) alone.push_back(plan(world, 10 + i).value());
  for (int round = 0; round < 5; ++round) {
    std::vector<motion::JointPath> together(kThreads);
    conformance::at_once(kThreads, [&](int i) {
      together[static_cast<std::size_t>(i)] = plan(world, 10 + i).value();
    });
    for (std::size_t i = 0; i < kThreads; ++i) {
      EXPECT_TRUE(conformance::same_bits(alone[i], together[i])) << "thread " << i;
    }
  }
}

TEST_P(PathPlannerConformance, StopsAtTheDeadline) {
  const auto world = conformance::closed_world();
  double worst = 0;
  for (double seconds : {0.0, 0.02, 0.1, 0.2}) {
    const auto begin = Clock::now();
    const auto path = plan(world, 1, StopCondition::after(seconds));
    worst = std::max(worst, conformance::seconds_since(begin) - seconds);
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().code, ErrorCode::kTimeout);
  }
  EXPECT_LT(worst, conformance::kStopSlack);
  RecordProperty("worst_overrun_ms", std::to_string(1e3 * worst));
  std::printf("worst overrun %.2f ms\n", 1e3 * worst);
}

TEST_P(PathPlannerConformance, StopsOnRequest) {
  const auto world = conformance::closed_world();
  std::stop_source source;
  Clock::time_point requested;
  const std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    requested = Clock::now();
    source.request_stop();
  });
  const auto path = plan(world, 1, StopCondition::after(20, source.get_token()));
  EXPECT_LT(conformance::seconds_since(requested), conformance::kStopSlack);
  ASSERT_FALSE(path);
  EXPECT_EQ(path.error().code, ErrorCode::kCancelled);
}

TEST_P(PathPlannerConformance, NamesTheEndThatCannotBeStoodAt) {
  const auto expect_infeasible = [&](const conformance::BallWorld& world, const char* end,
                                     const char* reason) {
    const auto path = plan(world, 1, StopCondition::after(1));
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().code, ErrorCode::kInfeasible);
    EXPECT_NE(path.error().message.find(end), std::string::npos) << path.error().message;
    EXPECT_NE(path.error().message.find(reason), std::string::npos) << path.error().message;
  };
  auto world = conformance::door_world();
  const auto good = world.problem;
  world.problem.start = world.centres[3];
  expect_infeasible(world, "start", "not valid");
  world.problem = good;
  world.problem.goal = world.centres[3];
  expect_infeasible(world, "goal", "not valid");
  world.problem = good;
  world.problem.start[1] = -2.5;
  expect_infeasible(world, "start", "joint 1");
  world.problem = good;
  world.problem.goal[0] = std::numeric_limits<double>::quiet_NaN();
  expect_infeasible(world, "goal", "joint 0");
  world.problem = good;
  world.problem.goal[0] = std::nextafter(2.0, 3.0);
  expect_infeasible(world, "goal", "joint 0");
}

TEST_P(PathPlannerConformance, StartAtTheGoalAndAtTheLimits) {
  auto world = conformance::door_world();
  world.problem.goal = world.problem.start;
  auto path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  ASSERT_EQ(path->size(), 2u);
  EXPECT_TRUE(conformance::same_bits(path->front(), world.problem.start));
  EXPECT_TRUE(conformance::same_bits(path->back(), world.problem.goal));

  world = conformance::door_world();
  world.problem.start = conformance::vector2(-2, -2);
  world.problem.goal = conformance::vector2(2, -2);
  path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);
}

TEST_P(PathPlannerConformance, JointsWithoutLimitsOrWithoutRange) {
  auto world = conformance::door_world();
  world.problem.lower[1] = -std::numeric_limits<double>::infinity();
  world.problem.upper[1] = std::numeric_limits<double>::infinity();
  auto path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);

  world = {};
  world.radius = 0.1;
  world.problem = {conformance::vector2(-1, 0.5), conformance::vector2(1, 0.5),
                   conformance::vector2(-2, 0.5), conformance::vector2(2, 0.5)};
  path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PathPlannerConformance);

struct SimplifierCase {
  std::string name;
  std::function<std::unique_ptr<PathSimplifier>()> make;
};

inline void PrintTo(const SimplifierCase& simplifier, std::ostream* out) {
  *out << simplifier.name;
}

class PathSimplifierConformance : public testing::TestWithParam<SimplifierCase> {
 protected:
  /// A crooked path by a plain random tree, valid by the world's own judgement.
  static motion::JointPath crooked(const conformance::BallWorld& world, std::uint64_t seed) {
    Rng rng(seed);
    const auto& [start, goal, lower, upper] = world.problem;
    motion::JointPath nodes{start};
    std::vector<std::size_t> parents{0};
    for (int tries = 0; tries < 20000; ++tries) {
      // Near the straight line and anywhere, in turns: one finds ways in many dimensions, one
      // doors.
      Eigen::VectorXd q = start + rng.uniform() * (goal - start);
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        q[j] = tries % 2 ? q[j] + rng.uniform(-1, 1) : rng.uniform(lower[j], upper[j]);
      }
      q = tries % 10 ? q.cwiseMax(lower).cwiseMin(upper).eval() : goal;
      const auto near = std::ranges::min_element(
          nodes, {}, [&](const Eigen::VectorXd& n) { return (n - q).squaredNorm(); });
      const double step = std::min(1.0, 0.6 / (q - *near).norm());
      const auto parent = static_cast<std::size_t>(near - nodes.begin());
      if (step < 1) q = *near + step * (q - *near);
      if (!(world.clearance(*near, q) > 0)) continue;
      nodes.push_back(q);
      parents.push_back(parent);
      if (!conformance::same_bits(q, goal)) continue;
      motion::JointPath path;
      for (std::size_t i = nodes.size() - 1; i != 0; i = parents[i]) path.push_back(nodes[i]);
      path.push_back(start);
      std::ranges::reverse(path);
      return path;
    }
    ADD_FAILURE() << "no path to simplify with seed " << seed;
    return {start, goal};
  }
  motion::JointPath simplify(const conformance::BallWorld& world, const motion::JointPath& path,
                             std::uint64_t seed, const StopCondition& stop = {}) const {
    conformance::BallValidity validity(world);
    return simplifier_->simplify(world.problem, path, validity, seed, stop);
  }
  std::unique_ptr<PathSimplifier> simplifier_ = GetParam().make();
};

TEST_P(PathSimplifierConformance, PathsGetShorterStayValidAndKeepTheirEnds) {
  for (const auto& world : {conformance::door_world(), conformance::arms_world()}) {
    double before = 0, after = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto path = crooked(world, seed);
      const auto shorter = simplify(world, path, seed);
      conformance::expect_good(shorter, world);
      EXPECT_LE(motion::joint_length(shorter), motion::joint_length(path) * (1 + 1e-12));
      before += motion::joint_length(path);
      after += motion::joint_length(shorter);
    }
    EXPECT_LT(after, 0.9 * before);
    std::printf("length %.2f -> %.2f\n", before / 10, after / 10);
  }
}

TEST_P(PathSimplifierConformance, EqualSeedsGiveEqualPathsAndOthersDiffer) {
  const auto world = conformance::arms_world();
  const auto path = crooked(world, 1);
  std::vector<motion::JointPath> results;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    results.push_back(simplify(world, path, seed));
    EXPECT_TRUE(conformance::same_bits(results.back(), simplify(world, path, seed)));
  }
  // A seed may matter little: not every pair has to differ.
  EXPECT_TRUE(std::ranges::any_of(results, [&](const motion::JointPath& result) {
    return !conformance::same_bits(result, results.front());
  }));
}

TEST_P(PathSimplifierConformance, ThreadsDoNotChangePaths) {
  constexpr int kThreads = 4;
  const auto world = conformance::arms_world();
  std::vector<motion::JointPath> paths, alone;
  for (std::size_t i = 0; i < kThreads; ++i) {
    paths.push_back(crooked(world, i));
    alone.push_back(simplify(world, paths[i], i));
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<motion::JointPath> together(kThreads);
    conformance::at_once(kThreads, [&](int k) {
      const auto i = static_cast<std::size_t>(k);
      together[i] = simplify(world, paths[i], i);
    });
    for (std::size_t i = 0; i < kThreads; ++i) {
      EXPECT_TRUE(conformance::same_bits(alone[i], together[i])) << "thread " << i;
    }
  }
}

TEST_P(PathSimplifierConformance, StopsWithAValidPath) {
  const auto world = conformance::arms_world();
  // Many waypoints and slow checks: work for seconds.
  const auto path = motion::interpolated(crooked(world, 1), 80);
  double worst = 0;
  for (double seconds : {0.0, 0.01, 0.05, 0.1, 0.2, 0.4}) {
    conformance::BallValidity validity(world, std::chrono::microseconds(300));
    const auto begin = Clock::now();
    const auto result =
        simplifier_->simplify(world.problem, path, validity, 1, StopCondition::after(seconds));
    worst = std::max(worst, conformance::seconds_since(begin) - seconds);
    conformance::expect_good(result, world);
    EXPECT_LE(motion::joint_length(result), motion::joint_length(path) * (1 + 1e-12));
  }
  EXPECT_LT(worst, conformance::kStopSlack);
  RecordProperty("worst_overrun_ms", std::to_string(1e3 * worst));
  std::printf("worst overrun %.2f ms\n", 1e3 * worst);
}

TEST_P(PathSimplifierConformance, ShortPathsAndDuplicates) {
  auto world = conformance::door_world();
  world.problem.goal = conformance::vector2(-1, 1.5);
  const auto& [start, goal, lower, upper] = world.problem;
  EXPECT_TRUE(conformance::same_bits(simplify(world, {start, goal}, 1), {start, goal}));
  const Eigen::VectorXd near_start = start + conformance::vector2(1e-11, 0);
  const Eigen::VectorXd near_goal = goal - conformance::vector2(0, 1e-11);
  conformance::expect_good(simplify(world, {start, start, near_start, near_goal, goal, goal}, 1),
                           world);
  conformance::expect_good(simplify(world, {start, conformance::vector2(-1.5, 0), goal}, 1), world);
}

/// A part of an accepted edge may be rejected, as with samples: yes or no by the bits of the edge.
class MoodyValidity : public conformance::BallValidity {
 public:
  MoodyValidity(const conformance::BallWorld& world, const motion::JointPath& accepted, double mood)
      : BallValidity(world), accepted_(accepted), mood_(mood) {}
  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
    const auto is_edge = [&](const Eigen::VectorXd& p, const Eigen::VectorXd& q) {
      for (std::size_t i = 1; i < accepted_.size(); ++i) {
        if (conformance::same_bits(p, accepted_[i - 1]) &&
            conformance::same_bits(q, accepted_[i])) {
          return true;
        }
      }
      return false;
    };
    if (is_edge(a, b) || is_edge(b, a)) return true;
    std::uint64_t bits = 0;
    for (const Eigen::VectorXd* q : {&a, &b}) {
      std::uint64_t end = 0;  // Summed over the ends, so that direction does not matter.
      for (double x : *q) end = (end ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15ull;
      bits += end ^ (end >> 29);
    }
    return Rng(bits).uniform() < mood_ && BallValidity::edge(a, b);
  }

 private:
  motion::JointPath accepted_;
  double mood_;  // Share of edges not rejected out of hand.
};

TEST_P(PathSimplifierConformance, EveryEdgeIsAcceptedEvenByMoodyValidity) {
  const auto world = conformance::arms_world();
  int shortened = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto path = crooked(world, seed);
    MoodyValidity validity(world, path, seed % 2 ? 0.8 : 0.2);
    const auto result = simplifier_->simplify(world.problem, path, validity, seed, {});
    conformance::expect_good(result, world);
    for (std::size_t i = 1; i < result.size(); ++i) {
      EXPECT_TRUE(validity.edge(result[i - 1], result[i])) << "seed " << seed << ", edge " << i;
    }
    EXPECT_LE(motion::joint_length(result), motion::joint_length(path) * (1 + 1e-12));
    shortened += motion::joint_length(result) < motion::joint_length(path);
  }
  EXPECT_GT(shortened, 0);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PathSimplifierConformance);

template <class Case>
std::string case_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

}  // namespace tandem::planning
