#pragma once
/// What every PathSimplifier must do; see planner_conformance.h for how to use it.

#include <bit>

#include "conformance/ball_world.h"

namespace tandem::planning {

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

}  // namespace tandem::planning
