#include "tandem/pipeline/curve.h"

#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/core/rng.h"
#include "tandem/planning/validity.h"

namespace tandem::pipeline {
namespace {

/// Random certified polylines of the small cell: the curve must always exist.
TEST(MakeCurve, NeverFailsOnACertifiedPolyline) {
  const auto cell = test::small_cell();
  const collision::CompiledCell compiled(cell);
  const collision::SsvChecker& checker = compiled.exact();
  const auto selection = cell->select(world::PairScope::all());
  const auto validity = planning::make_certified_validity(checker, selection);
  const auto timing = trajectory::make_barrier_optimizer();
  Rng rng(11);
  int repaired = 0, rest_to_rest = 0, paths = 0;
  while (paths < 60) {
    const auto random_q = [&] {
      Eigen::VectorXd q(cell->dof());
      for (int j = 0; j < q.size(); ++j) q[j] = rng.uniform(-2.4, 2.4);
      return q;
    };
    motion::JointPath path;
    for (int tries = 0; tries < 400 && path.size() < 2 + rng.index(8); ++tries) {
      const Eigen::VectorXd q = random_q();
      if (path.empty() ? validity->state(q) : validity->edge(path.back(), q)) path.push_back(q);
    }
    if (path.size() < 2) continue;
    ++paths;
    PlanReport report;
    const auto curve = make_curve({compiled, paths % 2 == 0, *timing, {}, report}, path, true);
    ASSERT_TRUE(curve) << curve.error().message;
    repaired += report.rungs.contains("repair");
    rest_to_rest += report.rungs.contains("rest_to_rest");
  }
  std::printf("of %d curves %d repaired, %d from rest to rest\n", paths, repaired, rest_to_rest);
  EXPECT_GT(repaired, 0);  // Else this test shows nothing.
}

TEST(MakeCurve, WithoutRepairNamesPairTimeAndDepth) {
  const auto cell = test::small_cell();
  const collision::CompiledCell compiled(cell);
  const auto timing = trajectory::make_barrier_optimizer();
  Eigen::VectorXd start = Eigen::VectorXd::Zero(8), goal;
  start << -0.3, -1.4, 0.5, 0, 0, -1.4, 0.5, 0;
  goal = start;
  goal[1] = 1.2;  // Straight through the table.
  for (const bool by_batches : {false, true}) {
    PlanReport report;
    const auto curve =
        make_curve({compiled, by_batches, *timing, {}, report}, {start, goal}, false);
    ASSERT_FALSE(curve);
    EXPECT_EQ(curve.error().code, ErrorCode::kCollision);
    EXPECT_NE(curve.error().message.find("left/link"), std::string::npos) << curve.error().message;
    EXPECT_NE(curve.error().message.find(" deep"), std::string::npos);
  }
}

}  // namespace
}  // namespace tandem::pipeline
