#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {
namespace {

double tool_length(const PlanReport& report, double ArmLengths::* length) {
  double sum = 0;
  for (const ArmLengths& arm : report.arms) sum += arm.*length;
  return sum;
}

const motion::JointPath& phase(const PlanReport& report, const std::string& name) {
  for (const Phase& phase : report.phases) {
    if (phase.name == name) return phase.path;
  }
  throw std::runtime_error("there is no phase " + name);
}

class ShortenOnSmallCell : public testing::Test {
 protected:
  Plan planned(std::uint64_t seed, const PlanOptions& options = {}) const {
    PlanOptions seeded = options;
    seeded.seed = seed;
    seeded.deadline = 30;
    auto plan = pipeline::plan(cell_, query_, seeded);
    if (!plan) throw std::runtime_error(plan.error().message);
    return std::move(*plan);
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  ResolvedQuery query_ = resolve(cell_, cell_->query("cross")).value();
};

TEST_F(ShortenOnSmallCell, PathsBecomeShorterAndStayProven) {
  double before = 0, after = 0, again = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const Plan plan = planned(seed);
    EXPECT_TRUE(plan.plpp);
    EXPECT_LE(tool_length(plan.report, &ArmLengths::L_after),
              tool_length(plan.report, &ArmLengths::L_before) * (1 + 1e-9));
    before += tool_length(plan.report, &ArmLengths::f_before);
    after += tool_length(plan.report, &ArmLengths::f_after);
    const auto& shortened = phase(plan.report, "shortened");
    const auto& thinned = phase(plan.report, "simplified_again");
    again += static_cast<double>(thinned.size()) / static_cast<double>(shortened.size());
    for (const auto* path : {&shortened, &thinned}) {
      EXPECT_EQ(path->front(), plan.ends.start);
      EXPECT_EQ(path->back(), plan.ends.goal);
      EXPECT_TRUE(certify_path(cell_, *path)) << certify_path(cell_, *path).error().message;
    }
  }
  EXPECT_LT(after, 0.8 * before);
  EXPECT_LT(again / 15, 0.7);
}

TEST_F(ShortenOnSmallCell, IsLeftOutOnRequest) {
  const Plan plan = planned(2, {.plpp = false});
  EXPECT_FALSE(plan.plpp);
  EXPECT_EQ(plan.report.phases.size(), 2u);
  EXPECT_EQ(plan.report.times.plpp, 0);
  EXPECT_EQ(plan.report.counts.shortenings, 0);
}

TEST_F(ShortenOnSmallCell, PaperPresetShortensByItsOwnSolver) {
  double before = 0, after = 0;
  int plans = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PlanReport report;
    // Executed curves may touch something: the report is filled all the same.
    static_cast<void>(
        plan(cell_, query_, {.preset = Preset::kPaper, .seed = seed, .deadline = 30}, &report));
    ASSERT_EQ(report.arms.size(), 2u);
    EXPECT_EQ(report.counts.shortenings, 1);
    EXPECT_TRUE(report.rungs.empty());
    EXPECT_GE(phase(report, "shortened").size(), 20u);
    before += tool_length(report, &ArmLengths::f_before);
    after += tool_length(report, &ArmLengths::f_after);
    ++plans;
  }
  EXPECT_EQ(plans, 10);
  EXPECT_LT(after, 0.9 * before);
}

}  // namespace
}  // namespace tandem::pipeline
