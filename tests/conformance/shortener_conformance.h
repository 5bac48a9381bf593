#pragma once
/// What every Shortener must do. Include in one source per test program and instantiate:
///   INSTANTIATE_TEST_SUITE_P(Mine, ShortenerConformance,
///                            testing::Values(ShortenerCase{"mine", {}, [] { return make_mine();
///                            }}), case_name<ShortenerCase>);

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "small_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"
#include "tandem/planning/ompl/ompl_planning.h"
#include "tandem/shortening/shortener.h"
#include "tandem/world/tool_poses.h"

namespace tandem::shortening {

struct ShortenerCase {
  std::string name;
  ShorteningOptions options;
  std::function<std::unique_ptr<Shortener>()> make;
};

inline void PrintTo(const ShortenerCase& shortener, std::ostream* out) { *out << shortener.name; }

template <class Case>
std::string case_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

/// Planned paths of the small cell, with `count` waypoints.
class ShortenerConformance : public testing::TestWithParam<ShortenerCase> {
 protected:
  motion::JointPath planned(std::uint64_t seed, int count = 12) const {
    const auto validity = planning::make_certified_validity(checker_, selection_);
    Eigen::VectorXd start(8), goal(8);
    start << 1.0, -0.2, 0.3, 0, 0.9, -0.3, 0.4, 0;
    goal << -0.8, -0.2, 0.3, 0, -0.9, -0.3, 0.4, 0;
    const planning::PathProblem problem{start, goal, cell_->lower(), cell_->upper()};
    const auto path =
        planning::make_ompl_rrt_connect()->plan(problem, *validity, seed, StopCondition::after(30));
    return motion::interpolated(path.value(), count);
  }
  Shortening shorten(const motion::JointPath& path, const ShorteningOptions& options,
                     const StopCondition& stop = {}) const {
    return shortener_->shorten(compiled_, world::PairScope::all(), path, options, stop);
  }
  double least_clearance(const Eigen::VectorXd& q) const {
    const auto scratch = checker_.make_scratch();
    return checker_.least_clearance(q, selection_, *scratch).distance;
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  collision::CompiledCell compiled_{cell_};
  const collision::SsvChecker& checker_ = compiled_.exact();
  world::PairSelection selection_ = cell_->select(world::PairScope::all());
  ShorteningOptions options_ = GetParam().options;
  std::unique_ptr<Shortener> shortener_ = GetParam().make();
};

TEST_P(ShortenerConformance, ShortensAndKeepsEndsClearanceAndLimits) {
  double before = 0, after = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto path = planned(seed);
    const Shortening result = shorten(path, options_);
    ASSERT_EQ(result.path.size(), path.size());
    EXPECT_EQ(result.path.front(), path.front());
    EXPECT_EQ(result.path.back(), path.back());
    EXPECT_LE(result.after, result.before);
    EXPECT_FALSE(result.stopped);
    before += result.before;
    after += result.after;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double had = std::min(options_.clearance, least_clearance(path[i]));
      EXPECT_GE(least_clearance(result.path[i]),
                had - result.violation - 0.021 * options_.clearance)
          << "seed " << seed << ", waypoint " << i;
      EXPECT_TRUE(cell_->check_position_limits(result.path[i]));
    }
  }
  EXPECT_LT(after, 0.6 * before);
}

TEST_P(ShortenerConformance, EqualInputGivesEqualPathsOnEveryThread) {
  const auto path = planned(3);
  const Shortening alone = shorten(path, options_);
  std::vector<Shortening> together(4);
  std::vector<std::jthread> threads;
  for (Shortening& result : together) {
    threads.emplace_back([&] { result = shorten(path, options_); });
  }
  threads.clear();
  for (const Shortening& result : together) EXPECT_EQ(result.path, alone.path);
}

TEST_P(ShortenerConformance, AnswersAStopWithTheBestSoFar) {
  const auto path = planned(4);
  std::stop_source source;
  source.request_stop();
  const Shortening result = shorten(path, options_, StopCondition::after(1e9, source.get_token()));
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.path, path);
  EXPECT_EQ(result.after, result.before);
}

TEST_P(ShortenerConformance, APathOfOneEdgeStaysAsItIs) {
  const auto path = planned(5);
  const motion::JointPath edge{path[0], path[1]};
  const Shortening result = shorten(edge, options_);
  EXPECT_EQ(result.path, edge);
  EXPECT_EQ(result.after, result.before);
  EXPECT_GT(result.before, 0);
}

TEST_P(ShortenerConformance, AnArmWithoutWeightIsLeftToTheJointTerm) {
  const auto path = planned(6);
  ShorteningOptions left_only = options_;
  left_only.weights.joints = 0;
  left_only.weights.arms = {1, 0};
  const Shortening result = shorten(path, left_only);
  EXPECT_LT(result.after, result.before);
  ShorteningOptions all = left_only;
  all.weights.arms = {1, 1};
  EXPECT_LT(result.after, shorten(path, all).after);
}

TEST_P(ShortenerConformance, KeepsEdgesAsShortAsAsked) {
  const auto path = planned(7, 14);
  ShorteningOptions spread = options_;
  spread.longest_edge = 1.2;
  spread.weights.joints = 0;
  const Shortening result = shorten(path, spread);
  const auto squared_edges = [&](const motion::JointPath& waypoints) {
    std::vector<double> lengths(waypoints.size() - 1, 0.0);
    for (const auto& X_WE : world::tool_poses(*cell_, waypoints)) {
      for (std::size_t i = 0; i < lengths.size(); ++i) {
        const std::span both(X_WE.data() + i, 2);
        lengths[i] += 2 * motion::cartesian_length(both).f;
      }
    }
    return lengths;
  };
  double mean = 0;
  for (double squared : squared_edges(path)) mean += std::sqrt(squared) / 13;
  for (double squared : squared_edges(result.path)) {
    EXPECT_LT(std::sqrt(squared), 1.2 * mean * 1.03);
  }
}

TEST_P(ShortenerConformance, RefusesWhatIsNoPath) {
  const auto path = planned(8);
  const auto run = [&](const motion::JointPath& waypoints, const ShorteningOptions& options) {
    shorten(waypoints, options);
  };
  EXPECT_THROW(run({path[0]}, options_), ContractViolation);
  motion::JointPath wrong = path;
  wrong[1].conservativeResize(3);
  EXPECT_THROW(run(wrong, options_), ContractViolation);
  ShorteningOptions none = options_;
  none.clearance = 0;
  EXPECT_THROW(run(path, none), ContractViolation);
  ShorteningOptions fewer = options_;
  fewer.edges = -1;
  EXPECT_THROW(run(path, fewer), ContractViolation);
  fewer.edges = 5;
  fewer.points_per_edge.assign(path.size() - 1, 1);
  EXPECT_THROW(run(path, fewer), ContractViolation);
  ShorteningOptions arms = options_;
  arms.weights.arms = {1};
  EXPECT_THROW(run(path, arms), ContractViolation);
}

}  // namespace tandem::shortening
