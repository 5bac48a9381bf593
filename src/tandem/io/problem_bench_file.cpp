#include "tandem/io/problem_bench_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "tandem/io/table.h"
#include "tandem/pipeline/bench.h"

namespace tandem::io {

using Json = nlohmann::ordered_json;
using pipeline::ProblemBenchResult;
using pipeline::ProblemCount;
using pipeline::ProblemRun;
using pipeline::Statistics;

namespace {

using Runs = std::vector<const ProblemRun*>;

struct Measure {
  const char* key;
  double (*of)(const ProblemRun&);
};

constexpr std::array<Measure, 5> kMeasures = {{
    {"plan_us", [](const ProblemRun& run) { return run.planning * 1e6; }},
    {"simplify_us", [](const ProblemRun& run) { return run.simplification * 1e6; }},
    {"total_us", [](const ProblemRun& run) { return (run.planning + run.simplification) * 1e6; }},
    {"length_before", [](const ProblemRun& run) { return run.length_before; }},
    {"length_after", [](const ProblemRun& run) { return run.length_after; }},
}};

/// Runs of one set, or of all if `set` is negative.
Runs runs_of(const ProblemBenchResult& result, int set) {
  Runs runs;
  for (const ProblemRun& run : result.runs) {
    if (set < 0 || run.set == set) runs.push_back(&run);
  }
  return runs;
}

ProblemCount total_of(const ProblemBenchResult& result) {
  ProblemCount total{"total", 0, 0};
  for (const ProblemCount& set : result.sets) {
    total.problems += set.problems;
    total.valid += set.valid;
  }
  return total;
}

Statistics measured(const Runs& runs, const Measure& measure) {
  std::vector<double> values;
  for (const ProblemRun* run : runs) {
    if (run->solved) values.push_back(measure.of(*run));
  }
  return Statistics::of(std::move(values));
}

std::size_t count(const Runs& runs, bool ProblemRun::* what) {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [&](const ProblemRun* run) { return run->*what; }));
}

/// What a run failed by: a solved one by its certificate.
std::string kind_of(const ProblemRun& run) {
  return run.solved ? "not_certified" : to_string(run.failure);
}

std::map<std::string, int> failure_kinds(const Runs& runs) {
  std::map<std::string, int> kinds;
  for (const ProblemRun* run : runs) {
    if (!run->certified) ++kinds[kind_of(*run)];
  }
  return kinds;
}

Json set_json(const ProblemCount& set, const Runs& runs) {
  Json json = {{"problems", set.problems},
               {"valid", set.valid},
               {"runs", runs.size()},
               {"solved", count(runs, &ProblemRun::solved)},
               {"certified", count(runs, &ProblemRun::certified)}};
  for (const Measure& measure : kMeasures) {
    const Statistics s = measured(runs, measure);
    json[measure.key] = {{"median", s.p50}, {"mean", s.mean}, {"p95", s.p95}, {"max", s.max}};
  }
  json["failure_kinds"] = Json::object();
  for (const auto& [kind, times] : failure_kinds(runs)) json["failure_kinds"][kind] = times;
  return json;
}

Json failures_json(const Runs& runs) {
  Json failures = Json::array();
  for (const ProblemRun* run : runs) {
    if (run->certified) continue;
    failures.push_back({{"problem", run->problem},
                        {"cycle", run->cycle},
                        {"kind", kind_of(*run)},
                        {"message", run->message}});
  }
  return failures;
}

std::vector<std::string> counts_row(const ProblemCount& set, const Runs& runs) {
  return {set.name,
          std::to_string(set.problems),
          std::to_string(set.valid),
          std::to_string(runs.size()),
          std::to_string(count(runs, &ProblemRun::solved)),
          std::to_string(count(runs, &ProblemRun::certified))};
}

void add_measures(Table& table, const ProblemCount& set, const Runs& runs) {
  for (const Measure& measure : kMeasures) {
    const Statistics s = measured(runs, measure);
    const int decimals = std::string(measure.key).starts_with("length") ? 3 : 1;
    std::vector<std::string> row{set.name + " " + measure.key};
    for (const double value : {s.p50, s.mean, s.p95, s.max}) {
      row.push_back(Table::number(value, decimals));
    }
    table.row(std::move(row));
  }
}

std::string failures_text(const ProblemBenchResult& result, bool list) {
  std::string text = "failures:";
  const Runs all = runs_of(result, -1);
  std::string separator = " ";
  for (const auto& [kind, times] : failure_kinds(all)) {
    text += separator + kind + " " + std::to_string(times);
    separator = ", ";
  }
  if (separator == " ") text += " none";
  text += "\n";
  for (const ProblemRun* run : all) {
    if (run->certified || !list) continue;
    text += "  " + result.sets[static_cast<std::size_t>(run->set)].name + " " + run->problem +
            ", cycle " + std::to_string(run->cycle) + ", " + kind_of(*run) + ": " + run->message +
            "\n";
  }
  return text;
}

}  // namespace

std::string problem_bench_json(const ProblemBenchResult& result) {
  Json json = {{"preset", to_string(result.options.preset)},
               {"strategy", to_string(result.options.strategy)},
               {"seed", result.options.seed},
               {"deadline_s", result.options.deadline},
               {"cycles", result.cycles},
               {"interrupted", result.runs.size() < result.planned_runs},
               {"sets", Json::object()}};
  for (std::size_t s = 0; s < result.sets.size(); ++s) {
    const Runs runs = runs_of(result, static_cast<int>(s));
    Json& set = json["sets"][result.sets[s].name];
    set = set_json(result.sets[s], runs);
    set["failures"] = failures_json(runs);
  }
  json["total"] = set_json(total_of(result), runs_of(result, -1));
  // Names come from files of any encoding; a result is worth more than a broken letter in it.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string problem_bench_table(const ProblemBenchResult& result, bool list_failures) {
  Table counts, measures;
  counts.row({"set", "problems", "valid", "runs", "solved", "certified"});
  measures.row({"solved runs", "median", "mean", "p95", "max"});
  const auto add = [&](const ProblemCount& set, int index) {
    const Runs runs = runs_of(result, index);
    counts.row(counts_row(set, runs));
    add_measures(measures, set, runs);
  };
  for (std::size_t s = 0; s < result.sets.size(); ++s) add(result.sets[s], static_cast<int>(s));
  if (result.sets.size() > 1) add(total_of(result), -1);
  return "preset " + std::string(to_string(result.options.preset)) + ", strategy " +
         to_string(result.options.strategy) + ", seed " + std::to_string(result.options.seed) +
         ", lengths in rad\n\n" + counts.text() + "\n" + measures.text() + "\n" +
         failures_text(result, list_failures);
}

}  // namespace tandem::io
