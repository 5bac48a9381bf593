#include "tandem/coordination/realization.h"

#include <gtest/gtest.h>

#include "conformance/coordination_cells.h"
#include "tandem/coordination/sequential.h"
#include "tandem/trajectory/spline.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::coordination {
namespace {

using Eigen::Vector2d, Eigen::VectorXd;

/// Discs along polylines, each timed within its limits and at rest at both ends.
test::CoordinationCase timed_case(const std::vector<std::vector<Vector2d>>& paths,
                                  double jerk = 80) {
  auto c = test::disc_case("timed", paths);
  c.arms.clear();
  const auto timing = trajectory::make_barrier_optimizer();
  std::vector<robot::JointLimits> limits(2, {-10, 10, 2, 10});
  for (robot::JointLimits& limit : limits) limit.jerk = jerk;
  for (const auto& path : paths) {
    const motion::JointPath waypoints(path.begin(), path.end());
    c.arms.push_back(
        trajectory::fit_spline(waypoints, timing->optimize(waypoints, limits).durations));
  }
  return c;
}

/// Ends, rest, continuity, limits and collisions by samples that know nothing of proofs.
void expect_good(const test::CoordinationCase& c, const Realization& done) {
  const world::Workcell& cell = c.checker->cell();
  const VectorXd T = durations(c.problem());
  const motion::JointState start = done.motion.at(0), end = done.motion.at(done.motion.duration());
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < c.arms.size(); ++i) {
    const Eigen::Index n = c.arms[i].dof();
    EXPECT_LT((start.q.segment(first, n) - c.arms[i].at(0).q).norm(), 1e-9);
    EXPECT_LT((end.q.segment(first, n) - c.arms[i].at(1e9).q).norm(), 1e-9);
    EXPECT_LT(done.motion.arms()[i].largest_jumps().maxCoeff(), 1e-6);
    first += n;
  }
  EXPECT_LT(start.qd.norm() + start.qdd.norm() + end.qd.norm() + end.qdd.norm(), 1e-6);
  EXPECT_TRUE(trajectory::check_limits(done.motion, cell.limits()).empty());
  const auto pairs = pairs_between_arms(cell);
  const auto scratch = c.checker->make_scratch();
  VectorXd q(cell.dof());
  for (int k = 0; k <= 4000; ++k) {
    done.motion.position(done.motion.duration() * k / 4000, q);
    const auto nearest = c.checker->least_clearance(q, pairs, *scratch);
    ASSERT_GE(nearest.distance, done.least_clearance - 1e-9) << k;
  }
  EXPECT_GT(done.least_clearance, 0);
}

Result<Realization> run(const test::CoordinationCase& c, const std::vector<VectorXd>& places,
                        const RealizationOptions& options = {}) {
  const auto scratch = c.checker->make_scratch();
  const Schedule schedule = make_schedule(places);
  EXPECT_TRUE(certify_schedule(c.problem(), schedule, *scratch).is_free());
  return realize(c.problem(), schedule, *c.compiled->batch().make_scratch(), {}, options);
}

/// Two discs that cross; the second one waits or slows down.
test::CoordinationCase crossing() { return timed_case({{{-1, 0}, {1, 0}}, {{0, -1}, {0, 1}}}); }

TEST(Realize, TheDiagonalTakesNoLongerThanTheSlowestArm) {
  const auto c = timed_case({{{-1, 0}, {1, 0}}, {{-1, 1}, {0, 1.5}, {1, 1}}});
  const VectorXd T = durations(c.problem());
  const auto done = run(c, {VectorXd::Zero(2), T});
  ASSERT_TRUE(done) << done.error().message;
  expect_good(c, *done);
  EXPECT_NEAR(done->motion.duration(), T.maxCoeff(), 1e-6 * T.maxCoeff());
  EXPECT_EQ(done->repairs, 0);
}

TEST(Realize, OneAfterTheOtherTakesTheSumOfTheDurations) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  const auto scratch = c.compiled->batch().make_scratch();
  const auto schedule = make_sequential_coordinator()->coordinate(c.problem(), 1, {});
  ASSERT_TRUE(schedule);
  const auto done = realize(c.problem(), *schedule, *scratch);
  ASSERT_TRUE(done) << done.error().message;
  expect_good(c, *done);
  EXPECT_NEAR(done->motion.duration(), T.sum(), 1e-6 * T.sum());
}

TEST(Realize, WaitsAtStartAndEndCostNothing) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  const auto done =
      run(c, {VectorXd::Zero(2), Vector2d(0.55 * T[0], 0), Vector2d(T[0], 0.45 * T[1]), T});
  ASSERT_TRUE(done) << done.error().message;
  expect_good(c, *done);
  EXPECT_LE(done->motion.duration(), 1.55 * T[0] + 1e-6);
}

TEST(Realize, ABendOnTheWayIsFollowedAndProven) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  // "b" slows down before the crossing, and is let go on once "a" has passed.
  const std::vector<VectorXd> places{VectorXd::Zero(2), Vector2d(0.6 * T[0], 0.4 * T[1]), T};
  const auto done = run(c, places);
  ASSERT_TRUE(done) << done.error().message;
  expect_good(c, *done);
  EXPECT_LT(done->motion.duration(), 1.25 * make_schedule(places).makespan());
}

TEST(Realize, GoesBackInTimeWhereTheScheduleDoes) {
  const auto c = timed_case({{{0, 0}, {1, 0}}, {{-1, 2}, {1, 2}}});
  const VectorXd T = durations(c.problem());
  const auto done = run(c, {VectorXd::Zero(2), Vector2d(0.6 * T[0], 0.3 * T[1]),
                            Vector2d(0.2 * T[0], 0.7 * T[1]), T});
  ASSERT_TRUE(done) << done.error().message;
  expect_good(c, *done);
  const auto& map = *done->motion.arms()[0].map();
  double least = 0;
  for (int k = 0; k <= 1000; ++k) least = std::min(least, map.at(map.duration() * k / 1000)[1]);
  EXPECT_LT(least, -0.1);
}

/// The bend touches the corner of what is blocked within a micrometre or so: the smooth motion must
/// be drawn near the polyline, or stop at its places.
TEST(Realize, RepairsOrStopsWhereASmoothMotionCannotPass) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  const auto problem = c.problem();
  const auto scratch = c.checker->make_scratch();
  const auto is_free = [&](double y) {
    return certify_schedule(
               problem,
               make_schedule({VectorXd::Zero(2), Vector2d(0.5 * T[0], 0), Vector2d(0.5 * T[0], y),
                              Vector2d(0.6 * T[0], y), Vector2d(0.6 * T[0], y), T}),
               *scratch)
        .is_free();
  };
  // "b" goes as near to the crossing as it may while "a" is in it.
  double low = 0, high = T[1];
  for (int i = 0; i < 40; ++i) {
    const double y = 0.5 * (low + high);
    (is_free(y) ? low : high) = y;
  }
  ASSERT_GT(low, 0.05 * T[1]);
  const std::vector<VectorXd> places{VectorXd::Zero(2), Vector2d(0.5 * T[0], 0),
                                     Vector2d(0.5 * T[0], low * 0.9999),
                                     Vector2d(0.75 * T[0], low * 0.9999), T};
  const auto smooth = run(c, places);
  ASSERT_TRUE(smooth) << smooth.error().message;
  expect_good(c, *smooth);
  const auto stops = run(c, places, {.repair_rounds = 0});
  ASSERT_TRUE(stops) << stops.error().message;
  expect_good(c, *stops);
  EXPECT_LE(smooth->motion.duration(), stops->motion.duration() + 1e-9);
}

TEST(Realize, RandomSchedulesOfManyArms) {
  Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    // Parallel lanes: every schedule is free, and only timing matters.
    std::vector<std::vector<Vector2d>> paths;
    const int arms = 2 + static_cast<int>(rng.index(3));
    for (int a = 0; a < arms; ++a) {
      paths.push_back({{rng.uniform(-1, 0), a},
                       {rng.uniform(0.1, 1), a + rng.uniform(-0.3, 0.3)},
                       {rng.uniform(1.1, 2), a}});
    }
    const auto c = timed_case(paths);
    const VectorXd T = durations(c.problem());
    std::vector<VectorXd> places{VectorXd::Zero(arms)};
    for (int k = 0; k < 4; ++k) {
      VectorXd place(arms);
      for (int a = 0; a < arms; ++a) {
        const double before = places.back()[a];
        place[a] = rng.index(3) == 0 ? before : before + rng.uniform(0, 0.5) * (T[a] - before);
      }
      if ((place - places.back()).cwiseAbs().maxCoeff() > 0) places.push_back(place);
    }
    places.push_back(T);
    const auto done = run(c, places);
    ASSERT_TRUE(done) << done.error().message;
    expect_good(c, *done);
    EXPECT_LT(done->motion.duration(), 2.5 * make_schedule(places).makespan());
  }
}

TEST(Realize, StopsWhenAsked) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  const auto scratch = c.compiled->batch().make_scratch();
  const auto late = realize(c.problem(), make_schedule({VectorXd::Zero(2), Vector2d(T[0], 0), T}),
                            *scratch, StopCondition::after(0));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::kTimeout);
}

std::optional<Realization> run_at_once(const test::CoordinationCase& c,
                                       const StopCondition& stop = {}) {
  return realize_at_once(c.problem(), *c.compiled->batch().make_scratch(), stop);
}

TEST(RealizeAtOnce, SlowsTheQuickerArmsDown) {
  const auto c = timed_case({{{-1, 0}, {1, 0}}, {{-1, 1}, {0, 1.5}, {1, 1}}, {{0, 3}, {0.1, 3}}});
  const VectorXd T = durations(c.problem());
  const auto done = run_at_once(c);
  ASSERT_TRUE(done);
  expect_good(c, *done);
  EXPECT_EQ(done->motion.duration(), T.maxCoeff());
  for (const motion::ArmMotion& arm : done->motion.arms()) {
    EXPECT_EQ(arm.duration(), T.maxCoeff()) << "all arrive at the same time";
  }
}

TEST(RealizeAtOnce, OrLetsThemWaitAtTheirEnds) {
  // "b" is out of the way of "a" only if it is not slowed down.
  const auto c = timed_case({{{-1.2, 0}, {1.2, 0}}, {{0, -0.45}, {0, 0.45}}});
  const VectorXd T = durations(c.problem());
  ASSERT_LT(T[1], T[0]);
  const auto scratch = c.checker->make_scratch();
  ASSERT_FALSE(
      certify_schedule(c.problem(), make_schedule({VectorXd::Zero(2), T}), *scratch).is_free());
  const auto done = run_at_once(c);
  ASSERT_TRUE(done);
  expect_good(c, *done);
  EXPECT_EQ(done->motion.duration(), T.maxCoeff());
}

TEST(RealizeAtOnce, IsNothingWhereTheArmsMeet) {
  EXPECT_FALSE(run_at_once(crossing()));
  EXPECT_FALSE(run_at_once(timed_case({{{-1, 0}, {1, 0}}, {{1, 0}, {-1, 0}}})));
  const auto apart = timed_case({{{-1, 0}, {1, 0}}, {{-1, 1}, {1, 1}}});
  EXPECT_TRUE(run_at_once(apart));
  EXPECT_FALSE(run_at_once(apart, StopCondition::after(0)));
}

TEST(RealizeInSequence, TakesTheSumOfTheDurationsInAnOrderThatIsFree) {
  // "b" is in the way of the other two at its start, "c" of "a" at its end.
  const auto c = timed_case({{{-1, 0}, {1, 0}}, {{0.3, 0}, {0.3, 1}}, {{0, 0.6}, {0, 0.1}}});
  const VectorXd T = durations(c.problem());
  const auto done = realize_in_sequence(c.problem(), *c.compiled->batch().make_scratch());
  ASSERT_TRUE(done);
  expect_good(c, *done);
  EXPECT_NEAR(done->motion.duration(), T.sum(), 1e-12);
  const auto runs = [&](std::size_t arm) {  // From when to when.
    const auto& knots = done->motion.arms()[arm].map()->knots();
    return std::pair(arm == 1 ? 0.0 : knots[1], arm == 1 ? knots[1] : knots[2]);
  };
  EXPECT_LE(runs(1).second, runs(0).first + 1e-12);
  EXPECT_LE(runs(0).second, runs(2).first + 1e-12);
}

TEST(RealizeInSequence, IsNothingWhereNoOrderIsFree) {
  const auto head_on = timed_case({{{-1, 0}, {1, 0}}, {{1, 0}, {-1, 0}}});
  EXPECT_FALSE(realize_in_sequence(head_on.problem(), *head_on.compiled->batch().make_scratch()));
  const auto c = crossing();
  const auto scratch = c.compiled->batch().make_scratch();
  EXPECT_TRUE(realize_in_sequence(c.problem(), *scratch));
  EXPECT_FALSE(realize_in_sequence(c.problem(), *scratch, StopCondition::after(0)));
}

/// The paper's figure: linear breaks the velocity, cubic and quintic keep C2, all are zero-clamped.
TEST(InterpolateUnrepaired, KeepsTheContinuityThatThePaperSays) {
  const auto c = timed_case({{{-1, 0}, {0, 0.5}, {1, 0}}, {{-1, 2}, {0, 2.5}, {1, 2}}});
  const VectorXd T = durations(c.problem());
  const auto scratch = c.checker->make_scratch();
  const Schedule schedule =
      make_schedule({VectorXd::Zero(2), Vector2d(0.4 * T[0], 0.2 * T[1]),
                     Vector2d(0.5 * T[0], 0.2 * T[1]), Vector2d(0.7 * T[0], 0.9 * T[1]), T});
  for (const Interpolation kind :
       {Interpolation::kLinear, Interpolation::kCubic, Interpolation::kQuintic}) {
    const auto made = interpolate_unrepaired(c.problem(), schedule, kind, *scratch);
    ASSERT_TRUE(made);
    Eigen::Vector3d jumps = Eigen::Vector3d::Zero();
    for (const auto& arm : made->motion.arms()) jumps = jumps.cwiseMax(arm.largest_jumps());
    EXPECT_LT(jumps[0], 1e-9);
    if (kind == Interpolation::kLinear) {
      EXPECT_GT(jumps[1], 0.1);
    } else {
      EXPECT_LT(jumps[1], 1e-8);
      EXPECT_LT(jumps[2], 1e-6);
    }
    const motion::JointState start = made->motion.at(0), end = made->motion.at(1e9);
    const motion::JointState last = made->motion.at(made->motion.duration());
    EXPECT_LT(start.qd.norm() + start.qdd.norm() + last.qd.norm() + last.qdd.norm(), 1e-6);
    EXPECT_LT((end.q - last.q).norm(), 1e-9);
    // Stretched by what it says, nothing is violated any more.
    std::vector<motion::ArmMotion> slow;
    for (const auto& arm : made->motion.arms()) slow.push_back(arm.stretched(made->stretch));
    const auto& limits = c.checker->cell().limits();
    if (kind != Interpolation::kLinear) {
      EXPECT_TRUE(trajectory::check_limits(motion::CellMotion(slow), limits).empty());
    }
    EXPECT_EQ(made->violations.empty(), made->stretch <= 1 + 1e-6);
  }
}

TEST(InterpolateUnrepaired, ReportsWhatTouches) {
  const auto c = crossing();
  const VectorXd T = durations(c.problem());
  const auto scratch = c.checker->make_scratch();
  const auto made = interpolate_unrepaired(c.problem(), make_schedule({VectorXd::Zero(2), T}),
                                           Interpolation::kCubic, *scratch);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->certificate.verdict, collision::Verdict::kCollision);
  EXPECT_TRUE(made->violations.empty());
}

}  // namespace
}  // namespace tandem::coordination
