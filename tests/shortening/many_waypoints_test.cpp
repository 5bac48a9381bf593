// What must not change where a path has many waypoints.

#include <ctime>

#include "planned_paths.h"
#include "tandem/core/rng.h"
#include "tandem/shortening/path_cost.h"
#include "tandem/shortening/proven_edges.h"

namespace tandem::shortening {
namespace {

using motion::JointPath;

using ManyWaypoints = PlannedPaths;

/// Means over paths.
struct Figures {
  double looks = 0;  ///< Configurations looked at, by waypoint.
  double iterations = 0;
  double f = 0;  ///< As if there were 20 waypoints.

  void add(const Shortening& result, double share) {
    const auto count = static_cast<double>(result.path.size());
    looks += share * static_cast<double>(result.evaluations) / count;
    iterations += share * result.iterations;
    f += share * result.after * (count - 1) / 19;
  }
};

TEST_F(ManyWaypoints, TakeNoMoreLooksEach) {
  for (const bool prove_edges : {false, true}) {
    Figures few, many;
    ShorteningOptions options;
    options.prove_edges = prove_edges;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      few.add(shorten(planned(seed, 20), options), 1.0 / 12);
      many.add(shorten(planned(seed, 160), options), 1.0 / 12);
    }
    EXPECT_LT(many.looks, few.looks);
    EXPECT_LT(many.f, 1.02 * few.f);
  }
}

// Bent everywhere, so that no path with fewer waypoints stands for it.
TEST_F(ManyWaypoints, OfACurveTakeAsManyIterations) {
  Rng rng(1);
  const auto curve = [&](std::uint64_t seed, int count) {
    JointPath path = planned(seed, count);
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      for (double& value : path[i]) value += rng.uniform(-1e-5, 1e-5);
    }
    return path;
  };
  Figures few, many;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    few.add(shorten(curve(seed, 20), {}), 1.0 / 12);
    many.add(shorten(curve(seed, 160), {}), 1.0 / 12);
  }
  EXPECT_LT(many.iterations, 1.5 * few.iterations);
  EXPECT_NEAR(many.f, few.f, 0.02 * few.f);
}

// On straight pieces, all of which are proven, and hardly longer than with all waypoints.
TEST_F(ManyWaypoints, AreMovedByFewEdgesOnRequest) {
  double all = 0, few = 0;
  long looks_with_all = 0, looks = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const JointPath path = planned(seed, 20);
    ShorteningOptions options;
    options.prove_edges = true;
    const Shortening complete = shorten(path, options);
    options.edges = 10;
    const Shortening result = shorten(path, options);
    all += complete.after;
    few += result.after;
    looks_with_all += complete.evaluations;
    looks += result.evaluations;
    ASSERT_EQ(result.path.size(), path.size());
    EXPECT_EQ(result.before, complete.before);
    EXPECT_NEAR(result.after, PathCost(*cell_, {}).path(result.path), 1e-12);
    int bends = 0;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const Eigen::VectorXd bend = result.path[i + 1] - 2 * result.path[i] + result.path[i - 1];
      bends += bend.norm() > 1e-9;
    }
    EXPECT_LE(bends, 13);
    const auto scratch = batch_.make_scratch();
    EXPECT_TRUE(unproven_edges(batch_, *pairs_, result.path, *scratch, {}).empty());
  }
  EXPECT_LT(few, 1.02 * all);
  EXPECT_LT(looks, 0.8 * static_cast<double>(looks_with_all));
}

TEST_F(ManyWaypoints, KeepEdgesAsShortAsAsked) {
  ShorteningOptions options;
  options.longest_edge = 1.2;
  options.weights.joints = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Shortening result = shorten(planned(seed, 100), options);
    const auto squared = [&](const JointPath& path, std::size_t edge) {
      ShorteningOptions whole;
      whole.weights.joints = 0;
      return 2 * shorten({path[edge], path[edge + 1]}, whole).after;
    };
    const JointPath before = planned(seed, 100);
    double mean = 0;
    for (std::size_t e = 0; e + 1 < before.size(); ++e) {
      mean += std::sqrt(squared(before, e)) / static_cast<double>(before.size() - 1);
    }
    for (std::size_t e = 0; e + 1 < before.size(); ++e) {
      EXPECT_LT(std::sqrt(squared(result.path, e)), 1.2 * mean * 1.03) << "edge " << e;
    }
    EXPECT_LT(result.after, result.before);
  }
}

// What is done after a stop, counted: with few waypoints, then with all, the reference is measured.
TEST_F(ManyWaypoints, AreHardlyLookedAtAfterAStop) {
  std::stop_source source;
  source.request_stop();
  const auto stop = StopCondition::after(1e9, source.get_token());
  const JointPath path = planned(1, 160);
  for (const int edges : {0, 10}) {
    ShorteningOptions options;
    options.prove_edges = true;
    options.edges = edges;
    const Shortening result = shorten(path, options, stop);
    EXPECT_TRUE(result.stopped);
    EXPECT_EQ(result.path, path);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_LE(result.evaluations, 6 * 160);
    EXPECT_LT(4 * result.evaluations, shorten(path, options).evaluations) << edges;
  }
}

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Time of the processor is counted, which others cannot take; the bound is against that of the
// complete search, so that sanitizers may slow both.
TEST_F(ManyWaypoints, ReturnSoonAfterAStop) {
  ShorteningOptions options;
  options.prove_edges = true;
  for (const std::uint64_t seed : {0, 3}) {
    const JointPath path = planned(seed, 160);
    double begin = processor_ms();
    const Shortening complete = shorten(path, options);
    const double whole = processor_ms() - begin;
    int stopped = 0, between = 0;
    double last = complete.before;
    for (int k = 0; k < 24; ++k) {
      const double deadline = k / 20.0 * whole;
      begin = processor_ms();
      const Shortening result = shorten(path, options, StopCondition::after(1e-3 * deadline));
      EXPECT_LT(processor_ms() - begin, deadline + 0.4 * whole) << "stopped after " << k << "/20";
      EXPECT_LE(result.after, result.before);
      stopped += result.stopped;
      between += result.stopped && result.after < last && result.after > complete.after;
      last = result.after;
    }
    EXPECT_GE(stopped, 5);
    EXPECT_GE(between, 2) << "what was found before the stop is lost";
  }
}

}  // namespace
}  // namespace tandem::shortening
