#include "tandem/io/bench_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tandem::io {
namespace {

using nlohmann::json;
using pipeline::BenchResult;
using pipeline::BenchRun;

BenchRun run(const std::string& query, double total, double duration) {
  BenchRun r;
  r.query = query;
  r.success = true;
  r.duration = duration;
  r.report.times.total = total;
  r.report.times.path_planning = total / 2;
  r.report.arms = {{10, 5, 4, 3, 2}, {1, 0.5, 0.4, 0.3, duration}};
  return r;
}

BenchRun failed(const std::string& query, ErrorCode code) {
  BenchRun r = run(query, 1e6, 1e6);  // Must not enter any statistics.
  r.success = false;
  r.failure = code;
  r.report.rungs = {{"repair", 1000}};
  return r;
}

BenchResult sample() {
  BenchResult result;
  result.workcell = "gearbox";
  result.options.preset = pipeline::Preset::kPaper;
  result.options.seed = 17;
  result.cycles = 3;
  result.arms = {"left", "right"};
  result.runs = {run("pick", 0.001, 1),
                 run("pick", 0.002, 2),
                 run("place", 0.006, 3),
                 failed("pick", ErrorCode::kNoPath),
                 failed("place", ErrorCode::kCollision),
                 failed("place", ErrorCode::kTimeout)};
  result.runs[0].report.rungs = {{"repair", 2}};
  result.runs[2].report.rungs = {{"repair", 1}, {"rest_to_rest", 1}};
  return result;
}

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back(key);
  return names;
}

TEST(BenchJson, HasExactlyTheKeysOfTheSchema) {
  const auto ordered = nlohmann::ordered_json::parse(bench_json(sample()));
  const std::vector<std::string> shared = {
      "queries",      "success",  "failures", "times_ms", "motion_duration_s",
      "makespan_s",   "f_before", "f_after",  "L_before", "L_after",
      "joint_length", "arms",     "rungs"};
  std::vector<std::string> top = {"workcell", "list", "preset", "strategy", "plpp", "cycles"};
  top.insert(top.end(), shared.begin(), shared.end());
  top.push_back("per_query");
  std::vector<std::string> found;
  for (const auto& [key, value] : ordered.items()) found.push_back(key);
  EXPECT_EQ(found, top);
  const json j = ordered;
  EXPECT_EQ(keys(j["per_query"]), (std::vector<std::string>{"pick", "place"}));
  EXPECT_EQ(j["per_query"]["pick"].size(), shared.size());
  EXPECT_EQ(keys(j["failures"]), (std::vector<std::string>{"collision", "coordination", "limits",
                                                           "planning", "timeout"}));
  EXPECT_EQ(keys(j["times_ms"]),
            (std::vector<std::string>{"certificate", "coordination", "distance", "path_planning",
                                      "plpp", "simplification", "total", "trajectory"}));
  EXPECT_EQ(keys(j["times_ms"]["total"]),
            (std::vector<std::string>{"max", "mean", "p50", "p95", "p99", "std"}));
  EXPECT_EQ(keys(j["arms"]["left"]), (std::vector<std::string>{"L_after", "L_before", "f_after",
                                                               "f_before", "joint_length"}));
}

TEST(BenchJson, CountsRunsAndMeasuresSuccessesOnly) {
  const json j = json::parse(bench_json(sample()));
  EXPECT_EQ(j["workcell"], "gearbox");
  EXPECT_EQ(j["preset"], "paper");
  EXPECT_EQ(j["strategy"], "centralized");
  EXPECT_EQ(j["plpp"], true);
  EXPECT_EQ(j["cycles"], 3);
  EXPECT_EQ(j["queries"], 6);
  EXPECT_EQ(j["success"], 3);
  EXPECT_EQ(j["failures"], json::parse(R"({"planning": 1, "collision": 1, "coordination": 0,
                                           "limits": 0, "timeout": 1})"));
  EXPECT_EQ(j["rungs"], json::parse(R"({"repair": 3, "rest_to_rest": 1})"));
  EXPECT_NEAR(j["times_ms"]["total"]["mean"].get<double>(), 3.0, 1e-12);
  EXPECT_NEAR(j["times_ms"]["total"]["p50"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(j["times_ms"]["total"]["max"].get<double>(), 6.0, 1e-12);
  EXPECT_NEAR(j["times_ms"]["path_planning"]["mean"].get<double>(), 1.5, 1e-12);
  EXPECT_EQ(j["times_ms"]["plpp"]["max"], 0);
  EXPECT_NEAR(j["motion_duration_s"]["mean"].get<double>(), 2.0, 1e-12);
  EXPECT_EQ(j["makespan_s"], j["motion_duration_s"]);
  EXPECT_NEAR(j["f_before"]["mean"].get<double>(), 11.0, 1e-12);
  EXPECT_NEAR(j["arms"]["left"]["f_before"]["mean"].get<double>(), 10.0, 1e-12);
  EXPECT_NEAR(j["arms"]["right"]["joint_length"]["max"].get<double>(), 3.0, 1e-12);
  EXPECT_NEAR(j["joint_length"]["max"].get<double>(), 5.0, 1e-12);
  EXPECT_EQ(j["per_query"]["pick"]["queries"], 3);
  EXPECT_EQ(j["per_query"]["pick"]["success"], 2);
  EXPECT_NEAR(j["per_query"]["place"]["times_ms"]["total"]["mean"].get<double>(), 6.0, 1e-12);
  EXPECT_EQ(j["per_query"]["place"]["rungs"]["rest_to_rest"], 1);
}

TEST(BenchJson, HasTheTimesOfEachArmWhereArmsArePlannedAlone) {
  BenchResult result = sample();
  EXPECT_FALSE(json::parse(bench_json(result))["arms"]["left"].contains("times_ms"));
  result.runs[0].report.arm_times.resize(2);
  result.runs[0].report.arm_times[1].plpp = 0.003;
  result.runs[2].report.arm_times.resize(2);
  result.runs[2].report.arm_times[1].plpp = 0.001;
  const json j = json::parse(bench_json(result));
  EXPECT_EQ(j["arms"]["left"]["times_ms"]["plpp"]["max"], 0);
  EXPECT_NEAR(j["arms"]["right"]["times_ms"]["plpp"]["mean"].get<double>(), 2.0, 1e-12);
  EXPECT_EQ(keys(j["arms"]["left"]["times_ms"]), keys(j["times_ms"]));
  EXPECT_NEAR(j["per_query"]["place"]["arms"]["right"]["times_ms"]["plpp"]["p50"].get<double>(),
              1.0, 1e-12);
  EXPECT_NE(bench_table(result).find("\n  right               2.000"), std::string::npos)
      << bench_table(result);
}

TEST(BenchJson, EveryFailureCodeIsCounted) {
  const std::vector<std::pair<ErrorCode, const char*>> kinds = {
      {ErrorCode::kInfeasible, "planning"}, {ErrorCode::kNoPath, "planning"},
      {ErrorCode::kCollision, "collision"}, {ErrorCode::kCoordination, "coordination"},
      {ErrorCode::kLimits, "limits"},       {ErrorCode::kTimeout, "timeout"}};
  for (const auto& [code, kind] : kinds) {
    BenchResult result = sample();
    result.runs = {failed("pick", code)};
    const json j = json::parse(bench_json(result));
    EXPECT_EQ(j["success"], 0);
    EXPECT_EQ(j["failures"][kind], 1) << kind;
    EXPECT_EQ(j["times_ms"]["total"]["max"], 0);
  }
}

TEST(BenchJson, NoRunsAtAll) {
  BenchResult result = sample();
  result.runs.clear();
  const json j = json::parse(bench_json(result));
  EXPECT_EQ(j["queries"], 0);
  EXPECT_EQ(j["per_query"], json::object());
  EXPECT_NE(bench_table(result).find("0 queries, 0 successful (0.0 %)"), std::string::npos);
}

TEST(BenchTable, ShowsWhatThePaperShows) {
  const std::string table = bench_table(sample());
  for (const char* words :
       {"workcell gearbox, preset paper, strategy centralized, seed 17",
        "3 whole cycles, 6 queries, 3 successful (50.0 %)", "mean", "p99",
        "failures: collision 1, coordination 0, limits 0, planning 1, timeout 1",
        "rungs: repair 3, rest_to_rest 1", "motion duration [s]", "total p50 [ms]"}) {
    EXPECT_NE(table.find(words), std::string::npos) << words << " in\n" << table;
  }
  const auto total = table.find("total [ms]");
  ASSERT_NE(total, std::string::npos);
  EXPECT_NE(table.substr(total, 60).find("3.000"), std::string::npos) << table;
}

}  // namespace
}  // namespace tandem::io
