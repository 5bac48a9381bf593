/// The published problem sets, where they are at hand.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "tandem/core/stop.h"
#include "tandem/io/problem_file.h"
#include "test_data.h"

namespace tandem::io {
namespace {

using pipeline::BenchProblem;
using test::data_path;
using Problems = std::vector<BenchProblem>;

Result<Problems> load(const std::string& file, const std::string& folder, const std::string& urdf,
                      const std::string& srdf) {
  ProblemRobots robots;
  robots.urdf[""] = data_path("robots/" + folder + "/" + urdf);
  robots.srdf[""] = data_path("robots/" + folder + "/" + srdf);
  return load_problems(data_path("problems/" + file), robots);
}

struct Counts {
  int problems = 0, valid = 0;
};

std::map<std::string, Counts> count(const Problems& problems) {
  std::map<std::string, Counts> sets;
  for (const BenchProblem& problem : problems) {
    ++sets[problem.set].problems;
    sets[problem.set].valid += problem.valid;
  }
  return sets;
}

/// Whether the cell can stand at both ends, by our checker.
Result<void> stand_at_ends(const BenchProblem& problem) {
  const auto cell = problem.cell();
  if (!cell) return std::unexpected(cell.error());
  return pipeline::check_ends(**cell, problem.ends);
}

/// Prints and counts the problems whose ends we and the file judge differently.
int disagreements(const Problems& problems) {
  int found = 0;
  for (const BenchProblem& problem : problems) {
    const auto ends = stand_at_ends(problem);
    if (ends.has_value() == problem.valid) continue;
    ++found;
    std::printf("%s %s: the file says %s, we say %s\n", problem.set.c_str(),
                problem.ends.name.c_str(), problem.valid ? "valid" : "invalid",
                ends ? "free" : ends.error().message.c_str());
  }
  return found;
}

TEST(ProblemData, PandaSetsAreCompleteAndWeAgreeOnTheirEnds) {
  TANDEM_SKIP_WITHOUT_DATA("problems/mbm/panda.json");
  const auto problems = load("mbm/panda.json", "panda_mbm", "panda_spherized.urdf", "panda.srdf");
  ASSERT_TRUE(problems) << problems.error().message;
  const auto sets = count(*problems);
  ASSERT_EQ(sets.size(), 5u);
  for (const auto& [name, counts] : sets) {
    EXPECT_EQ(counts.problems, 100) << name;
    EXPECT_EQ(counts.valid, name == "table_pick" ? 99 : 100) << name;
  }
  EXPECT_EQ((*problems)[0].ends.start.size(), 7);
  EXPECT_EQ(disagreements(*problems), 0);
}

TEST(ProblemData, BaxterSetsAreCompleteWithAnArmOnEitherSide) {
  TANDEM_SKIP_WITHOUT_DATA("problems/mbm/baxter.json");
  const auto problems =
      load("mbm/baxter.json", "baxter_mbm", "baxter_spherized.urdf", "baxter.srdf");
  ASSERT_TRUE(problems) << problems.error().message;
  const auto sets = count(*problems);
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets.at("bookshelf_tall_both_arms_easy").problems, 600);
  EXPECT_EQ(sets.at("bookshelf_tall_both_arms_easy").valid, 495);
  EXPECT_EQ(sets.at("bookshelf_tall_both_arms_medium").problems, 600);
  EXPECT_EQ(sets.at("bookshelf_tall_both_arms_medium").valid, 492);
  const auto cell = problems->front().cell();
  ASSERT_TRUE(cell) << cell.error().message;
  ASSERT_EQ((*cell)->arms().size(), 2u);
  EXPECT_EQ((*cell)->arms()[0].name, "left_arm");
  EXPECT_EQ((*cell)->arms()[1].name, "right_arm");
  EXPECT_EQ((*cell)->dof(), 14);
}

TEST(ProblemData, BaxterEndsAreJudgedAlikeAndCellsAreCheap) {
  TANDEM_SKIP_WITHOUT_DATA("problems/mbm/baxter.json");
  const auto problems =
      load("mbm/baxter.json", "baxter_mbm", "baxter_spherized.urdf", "baxter.srdf");
  ASSERT_TRUE(problems) << problems.error().message;
  const Clock::time_point begin = Clock::now();
  for (std::size_t i = 0; i < problems->size(); i += 4) ASSERT_TRUE((*problems)[i].cell());
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("%.0f us per cell\n", 1e6 * 4 * seconds / static_cast<double>(problems->size()));
  EXPECT_EQ(disagreements(*problems), 0);
}

TEST(ProblemData, PosesOfSeveralPandasAreFreeAndPairsComplete) {
  TANDEM_SKIP_WITHOUT_DATA("problems/vamp_mr/panda_two.json");
  const std::pair<const char*, std::size_t> expected[] = {
      {"panda_two", 110}, {"panda_two_rod", 132}, {"panda_four", 132}};
  for (const auto& [name, pairs] : expected) {
    const auto problems = load("vamp_mr/" + std::string(name) + ".json", "panda_mbm",
                               "panda_spherized_straight.urdf", "panda.srdf");
    ASSERT_TRUE(problems) << problems.error().message;
    EXPECT_EQ(problems->size(), pairs) << name;
    EXPECT_EQ(disagreements(*problems), 0) << name;
  }
}

}  // namespace
}  // namespace tandem::io
