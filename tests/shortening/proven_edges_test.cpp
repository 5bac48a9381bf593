#include "tandem/shortening/proven_edges.h"

#include <gtest/gtest.h>

#include "planned_paths.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/rng.h"

namespace tandem::shortening {
namespace {

using motion::JointPath;

class ProvenEdges : public PlannedPaths {
 protected:
  /// By the exact certificate, which the shortener does not use.
  bool is_certified(const JointPath& path) const {
    const auto scratch = exact_.make_scratch();
    for (std::size_t i = 1; i < path.size(); ++i) {
      const motion::StraightEdge edge(path[i - 1], path[i]);
      if (!collision::certify(exact_, edge, selection_, *scratch).is_free()) return false;
    }
    return true;
  }
  /// Only waypoints are looked at to begin with.
  static ShorteningOptions options(const JointPath& path, bool prove_edges) {
    ShorteningOptions options;
    options.prove_edges = prove_edges;
    options.clearance = 0.004;
    options.points_per_edge.assign(path.size() - 1, 0);
    return options;
  }

  const collision::SsvChecker& exact_ = compiled_.exact();
};

// The wall is thin, the clearance small and only waypoints are looked at to begin with, so that
// edges would pass through it: what comes out is proven all the same.
TEST_F(ProvenEdges, OfEveryResult) {
  double before = 0, after = 0;
  int unproven = 0;
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    const JointPath path = planned(seed, 8);
    const Shortening result = shorten(path, options(path, true));
    EXPECT_TRUE(is_certified(result.path)) << "seed " << seed;
    EXPECT_EQ(result.path.front(), path.front());
    EXPECT_EQ(result.path.back(), path.back());
    EXPECT_LE(result.after, result.before);
    before += result.before;
    after += result.after;
    unproven += !is_certified(shorten(path, options(path, false)).path);
  }
  EXPECT_LT(after, 0.8 * before);
  EXPECT_GE(unproven, 5) << "the test is too easy";
}

TEST_F(ProvenEdges, OfWhatAnInterruptedSearchReturns) {
  const JointPath path = planned(3, 30);
  int stopped = 0;
  const double complete = shorten(path, options(path, true)).after;
  for (int k = 0; k < 60; ++k) {
    const Shortening result = shorten(path, options(path, true), StopCondition::after(1e-4 * k));
    EXPECT_TRUE(is_certified(result.path)) << "stopped after " << 0.1 * k << " ms";
    EXPECT_LE(result.after, result.before);
    stopped += result.stopped;
    if (!result.stopped) {
      EXPECT_NEAR(result.after, complete, 1e-12);
    }
  }
  EXPECT_GE(stopped, 1);
}

TEST_F(ProvenEdges, AreDrawnBackOnlyWhereTheyMust) {
  Rng rng(1);
  int moved_some = 0;
  const auto scratch = batch_.make_scratch();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const JointPath safe = planned(seed, 14);
    JointPath path = safe;
    const auto first = 1 + rng.index(8);
    for (std::size_t i = first; i < first + 3; ++i) {
      for (double& value : path[i]) value += rng.uniform(-0.5, 0.5);
    }
    const JointPath wanted = path;
    const auto open = unproven_edges(batch_, *pairs_, path, *scratch, {});
    const int moved = draw_back(batch_, *pairs_, safe, path, *scratch, {});
    EXPECT_TRUE(is_certified(path));
    EXPECT_EQ(moved == 0, open.empty());
    EXPECT_LE(moved, 5);
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i + 1 < first || i > first + 3) {
        EXPECT_EQ(path[i], wanted[i]);
      }
    }
    moved_some += moved > 0;
  }
  EXPECT_GE(moved_some, 3);
}

TEST_F(ProvenEdges, AllAreOpenAfterAStop) {
  const JointPath path = planned(5);
  std::stop_source source;
  source.request_stop();
  const auto stop = StopCondition::after(1e9, source.get_token());
  const auto scratch = batch_.make_scratch();
  EXPECT_EQ(unproven_edges(batch_, *pairs_, path, *scratch, stop).size(), path.size() - 1);
  JointPath other = path;
  other[3][0] += 0.01;
  draw_back(batch_, *pairs_, path, other, *scratch, stop);
  EXPECT_EQ(other, path);
}

}  // namespace
}  // namespace tandem::shortening
