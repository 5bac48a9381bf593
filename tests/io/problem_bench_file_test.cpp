#include "tandem/io/problem_bench_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tandem::io {
namespace {

using nlohmann::json;
using pipeline::ProblemBenchResult;
using pipeline::ProblemRun;

/// Two sets; in "b" one run of three timed out and one path is not certified.
ProblemBenchResult result() {
  ProblemBenchResult result;
  result.cycles = 1;
  result.sets = {{"a", 4, 2}, {"b", 3, 3}};
  result.planned_runs = 5;
  const auto add = [&](int set, const char* name, double planning, double before) {
    ProblemRun run{.set = set, .problem = name, .message = {}};
    run.solved = run.certified = true;
    run.planning = planning;
    run.simplification = 2 * planning;
    run.length_before = before;
    run.length_after = before / 2;
    result.runs.push_back(run);
  };
  add(0, "1", 100e-6, 4);
  add(0, "2", 300e-6, 8);
  add(1, "1", 200e-6, 6);
  add(1, "2", 1.0, 100);
  result.runs.back().certified = false;
  result.runs.back().failure = ErrorCode::kCollision;
  result.runs.back().message = "edge 1 of 1 touches";
  result.runs.push_back({.set = 1, .problem = "3", .message = "too late"});
  result.runs.back().failure = ErrorCode::kTimeout;
  return result;
}

TEST(ProblemBenchJson, CountsAndStatisticsBySetAndInTotal) {
  const json document = json::parse(problem_bench_json(result()));
  const json& a = document["sets"]["a"];
  const json& b = document["sets"]["b"];
  const json& total = document["total"];
  EXPECT_EQ(a["problems"], 4);
  EXPECT_EQ(a["valid"], 2);
  EXPECT_EQ(a["solved"], 2);
  EXPECT_EQ(a["certified"], 2);
  EXPECT_EQ(b["solved"], 2);
  EXPECT_EQ(b["certified"], 1);
  EXPECT_EQ(total["problems"], 7);
  EXPECT_EQ(total["valid"], 5);
  EXPECT_EQ(total["runs"], 5);
  EXPECT_EQ(total["solved"], 4);
  EXPECT_NEAR(a["plan_us"]["median"].get<double>(), 200, 1e-9);
  EXPECT_NEAR(a["plan_us"]["max"].get<double>(), 300, 1e-9);
  EXPECT_NEAR(a["simplify_us"]["mean"].get<double>(), 400, 1e-9);
  EXPECT_NEAR(a["total_us"]["mean"].get<double>(), 600, 1e-9);
  EXPECT_NEAR(a["length_before"]["mean"].get<double>(), 6, 1e-12);
  EXPECT_NEAR(a["length_after"]["p95"].get<double>(), 2 + 0.95 * 2, 1e-12);
  for (const char* key : {"plan_us", "simplify_us", "total_us", "length_before", "length_after"}) {
    EXPECT_EQ(total[key].size(), 4u);  // median, mean, p95, max
  }
  EXPECT_EQ(total["failure_kinds"], json({{"not_certified", 1}, {"timeout", 1}}));
  EXPECT_FALSE(document["interrupted"].get<bool>());
}

TEST(ProblemBenchJson, ListsWhatFailed) {
  const json document = json::parse(problem_bench_json(result()));
  EXPECT_TRUE(document["sets"]["a"]["failures"].empty());
  const json& failures = document["sets"]["b"]["failures"];
  ASSERT_EQ(failures.size(), 2u);
  EXPECT_EQ(failures[0]["problem"], "2");
  EXPECT_EQ(failures[0]["kind"], "not_certified");
  EXPECT_EQ(failures[1]["kind"], "timeout");
  EXPECT_EQ(failures[1]["message"], "too late");
}

TEST(ProblemBenchJson, NothingRunIsAllZeros) {
  ProblemBenchResult nothing = result();
  nothing.runs.clear();
  const json document = json::parse(problem_bench_json(nothing));
  EXPECT_TRUE(document["interrupted"].get<bool>());
  EXPECT_EQ(document["total"]["solved"], 0);
  EXPECT_EQ(document["total"]["plan_us"]["median"], 0);
  EXPECT_NE(problem_bench_table(nothing, true).find("failures: none"), std::string::npos);
}

TEST(ProblemBenchTable, HasARowPerSetAndListsFailuresIfAsked) {
  const std::string brief = problem_bench_table(result(), false);
  const std::string full = problem_bench_table(result(), true);
  EXPECT_NE(brief.find("failures: not_certified 1, timeout 1\n"), std::string::npos) << brief;
  EXPECT_EQ(brief.find("too late"), std::string::npos);
  EXPECT_NE(full.find("b 3, cycle 0, timeout: too late"), std::string::npos) << full;
  for (const char* row : {"a plan_us", "b length_after", "total total_us"}) {
    EXPECT_NE(brief.find(row), std::string::npos) << brief;
  }
}

}  // namespace
}  // namespace tandem::io
