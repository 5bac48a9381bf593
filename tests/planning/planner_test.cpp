#include "tandem/planning/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::planning {
namespace {

using Eigen::VectorXd;
using motion::JointPath;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

/// Everything is valid but states with a first joint above `limit`.
class HalfSpace final : public Validity {
 public:
  explicit HalfSpace(double limit) : limit_(limit) {}
  bool state(const VectorXd& q) override { return q[0] <= limit_; }
  bool edge(const VectorXd& a, const VectorXd& b) override { return state(a) && state(b); }
  const ValidityStats& stats() const override { return stats_; }

 private:
  double limit_;
  ValidityStats stats_;
};

TEST(CheckProblem, AcceptsTheLimitsThemselves) {
  HalfSpace validity(10);
  EXPECT_TRUE(
      check_problem({vector({-1, 2}), vector({1, 2}), vector({-1, 2}), vector({1, 2})}, validity));
}

TEST(CheckProblem, NamesEndJointValueAndLimits) {
  HalfSpace validity(0.5);
  const VectorXd lower = vector({-1, -2}), upper = vector({1, 2});
  const auto message = [&](const VectorXd& start, const VectorXd& goal) {
    const auto result = check_problem({start, goal, lower, upper}, validity);
    EXPECT_FALSE(result);
    if (result) return std::string();
    EXPECT_EQ(result.error().code, ErrorCode::kInfeasible);
    return result.error().message;
  };
  EXPECT_EQ(message(vector({0, -2.5}), vector({0, 0})),
            "the start is outside the limits: joint 1 (of 2, from 0) is -2.5, its limits are -2 to "
            "2");
  EXPECT_EQ(message(vector({0, 0}), vector({1.25, 0})),
            "the goal is outside the limits: joint 0 (of 2, from 0) is 1.25, its limits are -1 to "
            "1");
  EXPECT_NE(message(vector({0, 0}), vector({0.75, 0})).find("the goal is not valid"),
            std::string::npos);
  EXPECT_NE(message(vector({0.75, 0}), vector({0, 0})).find("the start is not valid"),
            std::string::npos);
  EXPECT_NE(message(vector({0, std::nan("")}), vector({0, 0})).find("joint 1"), std::string::npos);
}

TEST(CheckProblem, UnequalSizesAreABug) {
  HalfSpace validity(10);
  const VectorXd two = vector({0, 0}), one = vector({0}), none;
  EXPECT_THROW(check_problem({two, one, two, two}, validity).value(), ContractViolation);
  EXPECT_THROW(check_problem({two, two, one, two}, validity).value(), ContractViolation);
  EXPECT_THROW(check_problem({none, none, none, none}, validity).value(), ContractViolation);
  EXPECT_THROW(check_problem({two, two, vector({1, 1}), two}, validity).value(), ContractViolation);
}

TEST(SearchBox, ReachesHalfATurnWhereThereAreNoLimits) {
  const auto box = search_box({vector({0.1, 2, -4}), vector({0.2, -3, 5}),
                               vector({-1, -kInfinity, -kInfinity}), vector({1, kInfinity, 6})});
  EXPECT_EQ(box.lower, vector({-1, -3 - std::numbers::pi, -4 - std::numbers::pi}));
  EXPECT_EQ(box.upper, vector({1, 2 + std::numbers::pi, 6}));
}

TEST(WithoutDuplicates, KeepsEndsAndWaypointsThatDiffer) {
  const VectorXd a = vector({0, 0}), b = vector({1, 0}), c = vector({1, 1});
  const VectorXd e = vector({1e-10, 0});
  const auto expect = [](const JointPath& path, const JointPath& wanted) {
    EXPECT_EQ(without_duplicates(path), wanted);
  };
  expect({a, b, c}, {a, b, c});
  expect({a, a, b, b, b, c, c}, {a, b, c});
  expect({a, a + e, b, b + e, c - e, c}, {a, b, c});
  expect({a, b, a, b}, {a, b, a, b});
  expect({a, c - e, c}, {a, c});
  expect({a, a + e}, {a, a + e});
  expect({a, a + e, a}, {a, a});
  expect({a, a}, {a, a});
  EXPECT_THROW(without_duplicates({a}), ContractViolation);
}

TEST(WithoutDuplicates, LeavesNoShortEdgeInRandomWalks) {
  Rng rng(5);
  for (int round = 0; round < 1000; ++round) {
    JointPath path{VectorXd::Zero(3)};
    for (int i = 0; i < 20; ++i) {
      VectorXd step(3);
      for (double& x : step) x = rng.uniform(-1, 1);
      path.push_back(path.back() + std::pow(10.0, rng.uniform(-11, 0)) * step);
    }
    const JointPath kept = without_duplicates(path);
    EXPECT_EQ(kept.front(), path.front());
    EXPECT_EQ(kept.back(), path.back());
    for (std::size_t i = 1; i < kept.size() && kept.size() > 2; ++i) {
      EXPECT_GE((kept[i] - kept[i - 1]).norm(), kSameWaypoint);
    }
  }
}

}  // namespace
}  // namespace tandem::planning
