#include "tandem/planning/validity.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <stdexcept>

#include "small_cell.h"
#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::planning {
namespace {

using collision::CollisionChecker;
using collision::PairClearance;
using Eigen::VectorXd;
using world::PairSelection;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Free where `rule` says so; remembers every configuration asked for.
class RuleChecker final : public CollisionChecker {
 public:
  explicit RuleChecker(std::function<bool(const VectorXd&)> rule) : rule_(std::move(rule)) {}
  const world::Workcell& cell() const override { throw std::logic_error("there is no cell"); }
  std::unique_ptr<Scratch> make_scratch() const override { return std::make_unique<Scratch>(); }
  bool is_free(const Eigen::Ref<const VectorXd>& q, const PairSelection&, Scratch&) const override {
    asked.push_back(q);
    return rule_(q);
  }
  PairClearance least_clearance(const Eigen::Ref<const VectorXd>&, const PairSelection&,
                                Scratch&) const override {
    throw std::logic_error("distances are not asked for");
  }
  void clearances(const Eigen::Ref<const VectorXd>&, const PairSelection&, double, Scratch&,
                  std::vector<PairClearance>&) const override {
    throw std::logic_error("distances are not asked for");
  }
  mutable std::vector<VectorXd> asked;

 private:
  std::function<bool(const VectorXd&)> rule_;
};

VectorXd random_vector(Rng& rng, Eigen::Index n, double size) {
  VectorXd v(n);
  for (double& x : v) x = rng.uniform(-size, size);
  return v;
}

struct ByValues {
  bool operator()(const VectorXd& a, const VectorXd& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  }
};

TEST(SampledValidity, SamplesAreNoFartherApartThanTheResolutionInL1) {
  Rng rng(1);
  for (int round = 0; round < 300; ++round) {
    const RuleChecker checker([](const VectorXd&) { return true; });
    const double resolution = std::pow(10.0, rng.uniform(-3, 1));
    const auto validity = make_sampled_validity(checker, {}, resolution);
    const VectorXd a = random_vector(rng, 5, 1), b = random_vector(rng, 5, 1);
    ASSERT_TRUE(validity->edge(a, b));
    std::vector<VectorXd> samples = checker.asked;
    const VectorXd d = b - a;
    std::ranges::sort(samples, {}, [&](const VectorXd& q) { return d.dot(q - a); });
    EXPECT_EQ(samples.front(), a);
    EXPECT_EQ(samples.back(), b);
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double gap = (samples[i] - samples[i - 1]).lpNorm<1>();
      EXPECT_LE(gap, resolution * (1 + 1e-9));
      EXPECT_GT(gap, 0) << "a sample is asked for twice";
    }
    // No finer than asked for.
    EXPECT_LE(static_cast<double>(samples.size()), d.lpNorm<1>() / resolution + 2 + 1e-6);
  }
}

TEST(SampledValidity, DirectionDoesNotMatter) {
  Rng rng(2);
  for (int round = 0; round < 300; ++round) {
    const RuleChecker forth([](const VectorXd&) { return true; });
    const RuleChecker back([](const VectorXd&) { return true; });
    const VectorXd a = random_vector(rng, 3, 2), b = random_vector(rng, 3, 2);
    make_sampled_validity(forth, {}, 0.05)->edge(a, b);
    make_sampled_validity(back, {}, 0.05)->edge(b, a);
    const std::multiset<VectorXd, ByValues> p(forth.asked.begin(), forth.asked.end());
    const std::multiset<VectorXd, ByValues> q(back.asked.begin(), back.asked.end());
    EXPECT_TRUE(std::ranges::equal(p, q));
  }
}

TEST(SampledValidity, AnyRejectedSampleRejectsTheEdge) {
  const VectorXd a = VectorXd::Zero(2), b = VectorXd::Ones(2);
  const RuleChecker all([](const VectorXd&) { return true; });
  ASSERT_TRUE(make_sampled_validity(all, {}, 0.1)->edge(a, b));
  for (const VectorXd& bad : all.asked) {
    const RuleChecker checker([&](const VectorXd& q) { return q != bad; });
    EXPECT_FALSE(make_sampled_validity(checker, {}, 0.1)->edge(a, b)) << bad.transpose();
  }
}

TEST(SampledValidity, FindsBroadObstaclesEarly) {
  // An obstacle over the middle tenth: half of the samples of a sweep, few of a bisection.
  const RuleChecker checker([](const VectorXd& q) { return std::abs(q[0] - 0.5) > 0.05; });
  const auto validity = make_sampled_validity(checker, {}, 1e-4);
  EXPECT_FALSE(validity->edge(VectorXd::Zero(1), VectorXd::Ones(1)));
  EXPECT_LE(checker.asked.size(), 10u);
}

TEST(SampledValidity, EdgesShorterThanTheResolution) {
  const RuleChecker checker([](const VectorXd&) { return true; });
  const auto validity = make_sampled_validity(checker, {}, kInfinity);
  const VectorXd a = VectorXd::Zero(2), b = VectorXd::Ones(2);
  EXPECT_TRUE(validity->edge(a, b));
  EXPECT_EQ(checker.asked.size(), 2u);
  EXPECT_TRUE(validity->edge(a, a));
}

TEST(SampledValidity, KeepsBooks) {
  const RuleChecker checker([](const VectorXd&) {
    const auto end = Clock::now() + std::chrono::milliseconds(1);
    while (Clock::now() < end) {
    }
    return true;
  });
  const auto validity = make_sampled_validity(checker, {}, 1.0);
  const auto begin = Clock::now();
  validity->state(VectorXd::Zero(1));
  validity->edge(VectorXd::Zero(1), VectorXd::Constant(1, 3));
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
  EXPECT_EQ(validity->stats().states, 1);
  EXPECT_EQ(validity->stats().edges, 1);
  EXPECT_EQ(checker.asked.size(), 5u);
  EXPECT_GE(validity->stats().seconds, 0.005);
  EXPECT_LE(validity->stats().seconds, elapsed);
}

TEST(SampledValidity, BugsOfTheCaller) {
  const RuleChecker checker([](const VectorXd&) { return true; });
  EXPECT_THROW(make_sampled_validity(checker, {}, 0), ContractViolation);
  EXPECT_THROW(make_sampled_validity(checker, {}, std::nan("")), ContractViolation);
  const auto validity = make_sampled_validity(checker, {}, 1);
  EXPECT_THROW(validity->edge(VectorXd::Zero(1), VectorXd::Zero(2)), ContractViolation);
  EXPECT_THROW(validity->edge(VectorXd::Zero(1), VectorXd::Constant(1, std::nan(""))),
               ContractViolation);
}

TEST(L1Extent, SumsRangesAndCountsEndlessJointsAsATurn) {
  EXPECT_DOUBLE_EQ(l1_extent(Eigen::Vector2d(-1, 0), Eigen::Vector2d(2, 0.5)), 3.5);
  EXPECT_DOUBLE_EQ(l1_extent(Eigen::Vector2d(-1, -kInfinity), Eigen::Vector2d(2, kInfinity)),
                   3 + 2 * std::numbers::pi);
}

TEST(CertifiedValidity, AgreesWithDenseSamples) {
  const auto cell = test::small_cell();
  const collision::SsvChecker checker(cell);
  const PairSelection all = cell->select(world::PairScope::all());
  const auto certified = make_certified_validity(checker, all);
  const auto sampled = make_sampled_validity(checker, all, 2e-3);
  Rng rng(7);
  int accepted = 0, rejected = 0, undecided = 0;
  for (int round = 0; round < 400; ++round) {
    const VectorXd a = random_vector(rng, cell->dof(), 1.2);
    const VectorXd b = a + random_vector(rng, cell->dof(), 0.4);
    const bool proven = certified->edge(a, b), seen = sampled->edge(a, b);
    EXPECT_EQ(proven, certified->edge(b, a)) << "round " << round;
    EXPECT_TRUE(seen || !proven) << "a certified edge touches something in round " << round;
    accepted += proven;
    rejected += !seen;
    undecided += seen && !proven;
  }
  EXPECT_GT(accepted, 40);
  EXPECT_GT(rejected, 40);
  // Only edges that graze something may stay undecided.
  EXPECT_LT(undecided, 8);
  EXPECT_EQ(certified->stats().edges, 800);
  std::printf("%d accepted, %d rejected, %d undecided; %.3f ms per edge\n", accepted, rejected,
              undecided, 1e3 * certified->stats().seconds / 800);
}

TEST(BatchValidity, AcceptsNearlyWhatTheCertificateAccepts) {
  const auto cell = test::small_cell();
  const collision::SsvChecker checker(cell);
  const collision::BatchChecker batch(checker);
  const PairSelection all = cell->select(world::PairScope::all());
  const auto fast = make_batch_validity(batch, all);
  const auto certified = make_certified_validity(checker, all);
  const auto sampled = make_sampled_validity(checker, all, 2e-3);
  Rng rng(8);
  int accepted = 0, different = 0;
  for (int round = 0; round < 400; ++round) {
    const VectorXd a = random_vector(rng, cell->dof(), 1.2);
    const VectorXd b = a + random_vector(rng, cell->dof(), 0.4);
    EXPECT_EQ(fast->state(a), certified->state(a)) << "round " << round;
    const bool proven = fast->edge(a, b);
    EXPECT_EQ(proven, fast->edge(b, a)) << "round " << round;
    EXPECT_TRUE(!proven || sampled->edge(a, b))
        << "a proven edge touches something in round " << round;
    accepted += proven;
    different += proven != certified->edge(a, b);
  }
  EXPECT_GT(accepted, 40);
  EXPECT_LT(different, 4);
  EXPECT_EQ(fast->stats().states, 400);
  EXPECT_EQ(fast->stats().edges, 800);
}

TEST(CertifiedValidity, AStopRejectsEdges) {
  const auto cell = test::small_cell();
  const collision::SsvChecker checker(cell);
  const PairSelection all = cell->select(world::PairScope::all());
  VectorXd q(cell->dof());
  for (int i = 0; i < 2; ++i) q.segment(4 * i, 4) = cell->named_state(i, "up").value();
  const VectorXd near = q + VectorXd::Constant(q.size(), 0.01);
  EXPECT_TRUE(make_certified_validity(checker, all)->edge(q, near));
  const auto stopped = make_certified_validity(checker, all, {}, StopCondition::after(0));
  EXPECT_FALSE(stopped->edge(q, near));
}

}  // namespace
}  // namespace tandem::planning
