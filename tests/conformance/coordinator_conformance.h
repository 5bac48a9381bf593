#pragma once
/// What every Coordinator must do. Include in one source per test program and instantiate:
///   INSTANTIATE_TEST_SUITE_P(Mine, CoordinatorConformance,
///                            testing::Values(CoordinatorCase{"mine", [] { return make_mine(); }}),
///                            coordinator_name);

#include <cstring>
#include <functional>
#include <thread>

#include "conformance/coordination_cells.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

/// Which of the schedules that exist a coordinator finds.
enum class Finds {
  kAll,         ///< Some schedule wherever there is one.
  kMonotone,    ///< Where there is one on which no arm goes back.
  kSequential,  ///< Where one arm after the other is free.
};

struct CoordinatorCase {
  std::string name;
  std::function<std::unique_ptr<Coordinator>()> make;
  Finds finds = Finds::kAll;
};

inline void PrintTo(const CoordinatorCase& c, std::ostream* out) { *out << c.name; }

inline std::string coordinator_name(const testing::TestParamInfo<CoordinatorCase>& info) {
  return info.param.name;
}

class CoordinatorConformance : public testing::TestWithParam<CoordinatorCase> {
 protected:
  Result<Schedule> coordinate(const test::CoordinationCase& c, std::uint64_t seed = 1,
                              const StopCondition& stop = StopCondition::after(20)) const {
    return coordinator_->coordinate(c.problem(), seed, stop);
  }
  static bool finds(const test::CoordinationCase& c) {
    switch (GetParam().finds) {
      case Finds::kAll:
        return !c.deadlocks;
      case Finds::kMonotone:
        return !c.deadlocks && !c.goes_back;
      case Finds::kSequential:
        return c.in_sequence;
    }
    return false;
  }
  static bool same_bits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) ==
               0;
  }
  static bool same_bits(const Schedule& a, const Schedule& b) {
    return a.times == b.times &&
           std::ranges::equal(a.places, b.places, [](auto& p, auto& q) { return same_bits(p, q); });
  }
  static void expect_good(const test::CoordinationCase& c, const Schedule& schedule);

  std::unique_ptr<Coordinator> coordinator_ = GetParam().make();
};

/// Ends, speeds, and freedom: proven again, and by samples that know nothing of proofs.
inline void CoordinatorConformance::expect_good(const test::CoordinationCase& c,
                                                const Schedule& schedule) {
  const auto problem = c.problem();
  const Eigen::VectorXd T = durations(problem);
  ASSERT_GE(schedule.places.size(), 2u);
  ASSERT_EQ(schedule.places.size(), schedule.times.size());
  EXPECT_TRUE(same_bits(schedule.places.front(), Eigen::VectorXd::Zero(T.size())));
  EXPECT_TRUE(same_bits(schedule.places.back(), T));
  EXPECT_EQ(schedule.times.front(), 0.0);
  EXPECT_GE(schedule.makespan(), T.maxCoeff() - 1e-9);
  const auto scratch = c.checker->make_scratch();
  const auto pairs = pairs_between_arms(c.checker->cell());
  Eigen::VectorXd q(c.checker->cell().dof());
  for (std::size_t k = 1; k < schedule.places.size(); ++k) {
    const Eigen::VectorXd &a = schedule.places[k - 1], &b = schedule.places[k];
    ASSERT_EQ(b.size(), T.size());
    const double dt = schedule.times[k] - schedule.times[k - 1];
    ASSERT_GT(dt, 0) << "place " << k;
    EXPECT_LE((b - a).cwiseAbs().maxCoeff(), dt + 1e-9) << "place " << k;
    EXPECT_TRUE((b.array() >= 0).all() && (b.array() <= T.array()).all()) << "place " << k;
    if (GetParam().finds != Finds::kAll) {
      EXPECT_TRUE((b.array() >= a.array()).all()) << "goes back at place " << k;
    }
    const PlacesEdge edge(problem.arms, a, b);
    for (int s = 0; s <= 200; ++s) {
      edge.position(s / 200.0, q);
      ASSERT_TRUE(c.checker->is_free(q, pairs, *scratch)) << "edge " << k << " at " << s / 200.0;
    }
  }
  EXPECT_TRUE(certify_schedule(problem, schedule, *scratch).is_free());
}

TEST_P(CoordinatorConformance, CoordinatesDiscsWhereItCan) {
  for (const auto& c : test::disc_cases()) {
    SCOPED_TRACE(c.name);
    const auto schedule = coordinate(c);
    EXPECT_EQ(schedule.has_value(), finds(c));
    if (schedule) {
      expect_good(c, *schedule);
    } else {
      EXPECT_EQ(schedule.error().code, ErrorCode::kCoordination) << schedule.error().message;
      EXPECT_NE(schedule.error().message.find("/disc"), std::string::npos)
          << schedule.error().message;
    }
  }
}

TEST_P(CoordinatorConformance, SchedulesOfArmsAreFree) {
  int found = 0, tried = 0;
  for (std::uint64_t seed = 0; seed < 400 && tried < 25; ++seed) {
    const auto c = test::swinging_arms(seed);
    if (!c) continue;
    SCOPED_TRACE(c->name);
    ++tried;
    const auto schedule = coordinate(*c, seed);
    if (schedule) {
      ++found;
      expect_good(*c, *schedule);
    } else {
      EXPECT_EQ(schedule.error().code, ErrorCode::kCoordination) << schedule.error().message;
    }
  }
  EXPECT_EQ(tried, 25);
  EXPECT_GT(found, 10);
}

TEST_P(CoordinatorConformance, AlternativesAreGoodSchedulesInOrder) {
  for (const auto& c : test::disc_cases()) {
    if (!finds(c)) continue;
    SCOPED_TRACE(c.name);
    const auto some = coordinator_->alternatives(c.problem(), 3, 1, StopCondition::after(20));
    ASSERT_TRUE(some) << some.error().message;
    ASSERT_GE(some->size(), 1u);
    EXPECT_LE(some->size(), 3u);
    EXPECT_TRUE(same_bits(some->front(), *coordinate(c)));
    for (std::size_t k = 0; k < some->size(); ++k) {
      expect_good(c, (*some)[k]);
      if (k < 2) continue;  // The first is what coordinate() takes, however good.
      EXPECT_GE((*some)[k].makespan(), (*some)[k - 1].makespan() - 1e-12);
    }
  }
}

TEST_P(CoordinatorConformance, EqualSeedsGiveEqualSchedulesOnAnyThread) {
  const auto c = test::crossing();
  const auto first = coordinate(c, 7);
  ASSERT_TRUE(first);
  std::vector<Schedule> others(4);
  {
    std::vector<std::jthread> threads;
    for (Schedule& other : others) {
      threads.emplace_back([&] { other = coordinate(c, 7).value(); });
    }
  }
  for (const Schedule& other : others) EXPECT_TRUE(same_bits(other, *first));
}

TEST_P(CoordinatorConformance, NamesThePairThatTouchesAtAnEnd) {
  const auto start = test::disc_case("start", {{{0, 0}, {1, 0}}, {{0.1, 0}, {0, 1}}});
  const auto goal = test::disc_case("goal", {{{1, 0}, {0, 0}}, {{0, 1}, {0.1, 0}}});
  for (const auto& c : {start, goal}) {
    const auto schedule = coordinate(c);
    ASSERT_FALSE(schedule);
    EXPECT_EQ(schedule.error().code, ErrorCode::kInfeasible);
    EXPECT_NE(schedule.error().message.find(c.name), std::string::npos);
    EXPECT_NE(schedule.error().message.find("a/disc and b/disc"), std::string::npos)
        << schedule.error().message;
  }
}

TEST_P(CoordinatorConformance, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  for (const auto& c : {test::crossing(), test::head_on()}) {
    const auto cancelled = coordinate(c, 1, StopCondition::after(20, source.get_token()));
    ASSERT_FALSE(cancelled);
    EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
    const auto late = coordinate(c, 1, StopCondition::after(0));
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, ErrorCode::kTimeout);
  }
}

TEST_P(CoordinatorConformance, RefusesMotionsThatAreNotTheArms) {
  auto c = test::crossing();
  c.arms.pop_back();
  EXPECT_THROW(std::ignore = coordinate(c), ContractViolation);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(CoordinatorConformance);

}  // namespace tandem::coordination
