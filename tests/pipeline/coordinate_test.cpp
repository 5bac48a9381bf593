#include "tandem/pipeline/coordinate.h"

#include "conformance/coordination_cells.h"
#include "tandem/coordination/realization.h"
#include "tandem/trajectory/spline.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::pipeline {
namespace {

using coordination::test::CoordinationCase;
using Eigen::Vector2d, Eigen::VectorXd;

/// Two discs on random ways in a space that is hardly large enough for both, each timed within its
/// limits; nothing if they touch at their starts or their ends.
std::optional<CoordinationCase> crowded(std::uint64_t seed) {
  Rng rng(seed);
  std::vector<std::vector<Vector2d>> paths(2);
  for (auto& path : paths) {
    const std::size_t waypoints = 3 + rng.index(4);
    for (std::size_t k = 0; k < waypoints; ++k) {
      path.push_back({rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)});
    }
  }
  auto c = coordination::test::disc_case("crowded", paths);
  c.arms.clear();
  const auto timing = trajectory::make_barrier_optimizer();
  const std::vector<robot::JointLimits> limits(2, {-10, 10, 2, 10, 80});
  for (const auto& path : paths) {
    const motion::JointPath waypoints(path.begin(), path.end());
    c.arms.push_back(
        trajectory::fit_spline(waypoints, timing->optimize(waypoints, limits).durations));
  }
  if (!coordination::check_problem(c.problem(), *c.checker->make_scratch())) return std::nullopt;
  return c;
}

/// Samples that know nothing of proofs.
void expect_free(const CoordinationCase& c, const motion::CellMotion& motion) {
  const auto pairs = coordination::pairs_between_arms(c.checker->cell());
  const auto scratch = c.checker->make_scratch();
  VectorXd q(motion.dof());
  for (int k = 0; k <= 2000; ++k) {
    motion.position(motion.duration() * k / 2000, q);
    ASSERT_TRUE(c.checker->is_free(q, pairs, *scratch)) << k;
  }
}

TEST(Coordinate, RunsOneAfterTheOtherWhereNothingQuickerIsFound) {
  int coordinated = 0, in_sequence = 0, none = 0;
  for (std::uint64_t seed = 200; seed < 460; ++seed) {
    const auto c = crowded(seed);
    if (!c) continue;
    SCOPED_TRACE(seed);
    PlanReport report;
    const auto motion = coordinate(*c->compiled, c->arms, {}, {}, report);
    const double sum = coordination::durations(c->problem()).sum();
    if (!motion) {
      ++none;
      EXPECT_EQ(motion.error().code, ErrorCode::kCoordination) << motion.error().message;
      const auto scratch = c->compiled->batch().make_scratch();
      EXPECT_FALSE(coordination::realize_in_sequence(c->problem(), *scratch));
      continue;
    }
    expect_free(*c, *motion);
    EXPECT_GT(report.least_clearance, 0);
    EXPECT_LE(motion->duration(), sum + 1e-9) << "no motion is longer";
    (report.rungs.contains("one_after_the_other") ? in_sequence : coordinated)++;
    if (report.rungs.contains("one_after_the_other")) {
      EXPECT_NEAR(motion->duration(), sum, 1e-9);
    }
  }
  std::printf("%d coordinated, %d in sequence, %d not at all\n", coordinated, in_sequence, none);
  EXPECT_GT(coordinated, 30);
  EXPECT_GE(in_sequence, 2);
  EXPECT_GT(none, 30);
}

}  // namespace
}  // namespace tandem::pipeline
