#include <gtest/gtest.h>

#include "conformance/coordination_cells.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {
namespace {

using Eigen::Vector2d, Eigen::VectorXd;

TEST(MakeSchedule, TimesByTheFasterArmAndDropsRepeatedPlaces) {
  const Schedule schedule = make_schedule(
      {Vector2d(0, 0), Vector2d(1, 0.5), Vector2d(1, 0.5), Vector2d(0.5, 2), Vector2d(2, 2)});
  EXPECT_EQ(schedule.places.size(), 4u);
  EXPECT_EQ(schedule.times, (std::vector{0.0, 1.0, 2.5, 4.0}));
  EXPECT_EQ(schedule.makespan(), 4.0);
  EXPECT_THROW(std::ignore = make_schedule({}), ContractViolation);
}

TEST(PlacesEdge, IsTheArmsAtTheirLocalTimesWithTheirDerivatives) {
  Rng rng(1);
  for (int n = 0; n < 50; ++n) {
    auto swinging = test::swinging_arms(rng.split());
    while (!swinging) swinging = test::swinging_arms(rng.split());
    const test::CoordinationCase& c = *swinging;
    const VectorXd T = durations(c.problem());
    VectorXd a(2), b(2);
    for (int i : {0, 1}) a[i] = rng.uniform(0, T[i]), b[i] = rng.uniform(0, T[i]);
    const PlacesEdge edge(c.arms, a, b);
    ASSERT_EQ(edge.dof(), 8);
    const double t = rng.uniform();
    VectorXd q(8), later(8), earlier(8);
    edge.position(t, q);
    for (int i : {0, 1}) {
      VectorXd alone(4);
      c.arms[static_cast<std::size_t>(i)].position(a[i] + t * (b[i] - a[i]), alone);
      EXPECT_EQ(q.segment(4 * i, 4), alone);
    }
    const auto state = edge.at(t);
    EXPECT_EQ(state.q, q);
    const double h = 1e-6;
    edge.position(t + h, later);
    edge.position(t - h, earlier);
    EXPECT_TRUE(state.qd.isApprox((later - earlier) / (2 * h), 1e-5));
    EXPECT_TRUE(state.qddd.isApprox((edge.at(t + h).qdd - edge.at(t - h).qdd) / (2 * h), 1e-3) ||
                (edge.at(t + h).qddd != edge.at(t - h).qddd));

    // Deviations hold in every sample and are reached in one, in both directions.
    const double t0 = rng.uniform(0, t), t1 = rng.uniform(t, 1);
    VectorXd D(8), middle(8), most = VectorXd::Zero(8);
    edge.deviation(t0, t1, D);
    edge.position(0.5 * (t0 + t1), middle);
    for (int s = 0; s <= 500; ++s) {
      edge.position(t0 + s / 500.0 * (t1 - t0), q);
      most = most.cwiseMax((q - middle).cwiseAbs());
    }
    EXPECT_TRUE((most.array() <= D.array() + 1e-12).all());
    EXPECT_TRUE(((D - most).array() < 1e-4).all());
  }
}

TEST(CertifySchedule, FindsWhenItTouches) {
  const auto c = test::crossing();
  const auto scratch = c.checker->make_scratch();
  const Vector2d start(0, 0), goal(1, 1);
  // On the diagonal both discs are at the middle at once.
  const auto both = certify_schedule(c.problem(), make_schedule({start, goal}), *scratch);
  EXPECT_EQ(both.verdict, collision::Verdict::kCollision);
  EXPECT_NEAR(both.time, 0.5, 0.11);
  const auto one_by_one =
      certify_schedule(c.problem(), make_schedule({start, Vector2d(1, 0), goal}), *scratch);
  EXPECT_TRUE(one_by_one.is_free());
  // "b" starts 1 m below the way of "a".
  EXPECT_GT(one_by_one.least_clearance, 0);
  EXPECT_LE(one_by_one.least_clearance, 0.8 + 1e-9);
  const auto late = certify_schedule(
      c.problem(), make_schedule({start, Vector2d(0.5, 0), Vector2d(0.5, 1), goal}), *scratch);
  EXPECT_EQ(late.verdict, collision::Verdict::kCollision);
  EXPECT_NEAR(late.time, 1.0, 0.2);
}

TEST(DescribeBlocking, NamesLinksArmsAndTimes) {
  const auto c = test::crossing();
  EXPECT_EQ(describe_blocking(c.checker->cell(), 0, Vector2d(0.25, 1.5)),
            "a/disc and b/disc with a at 0.250 s and b at 1.500 s of their own motions");
}

}  // namespace
}  // namespace tandem::coordination
