#include "tandem/io/bench_file.h"

#include <nlohmann/json.hpp>

#include "tandem/io/bench_measures.h"

namespace tandem::io {

using Json = nlohmann::ordered_json;
using pipeline::Statistics;

namespace {

Json statistics_json(const Statistics& s) {
  return {{"mean", s.mean}, {"std", s.std}, {"p50", s.p50},
          {"p95", s.p95},   {"p99", s.p99}, {"max", s.max}};
}

/// f_before ... joint_length of arm `arm`, or summed over all arms if -1.
void add_lengths(Json& json, const Runs& runs, int arm) {
  for (const auto& [key, member] : kLengthKeys) {
    json[key] = statistics_json(measure_length(runs, member, arm));
  }
}

/// Everything that is measured alike for all queries together and for one.
void add_measures(Json& json, const Runs& runs, const std::vector<std::string>& arms) {
  json["queries"] = runs.size();
  json["success"] = successes(runs).size();
  const auto counts = failures_by_kind(runs);
  for (const char* kind : kFailureKinds) json["failures"][kind] = counts.at(kind);
  for (const auto& [key, member] : kTimeKeys) {
    json["times_ms"][key] = statistics_json(measure_ms(runs, member));
  }
  json["motion_duration_s"] = statistics_json(measure_duration(runs));
  json["makespan_s"] = json["motion_duration_s"];
  add_lengths(json, runs, -1);
  json["arms"] = Json::object();
  for (std::size_t i = 0; i < arms.size(); ++i) {
    Json& arm = json["arms"][arms[i]];
    add_lengths(arm, runs, static_cast<int>(i));
    if (!has_arm_times(runs)) continue;
    for (const auto& [key, member] : kTimeKeys) {
      arm["times_ms"][key] = statistics_json(measure_arm_ms(runs, member, static_cast<int>(i)));
    }
  }
  json["rungs"] = Json::object();
  for (const auto& [rung, count] : rung_counts(runs)) json["rungs"][rung] = count;
}

}  // namespace

std::string bench_json(const pipeline::BenchResult& result) {
  Json json = {{"workcell", result.workcell},
               {"list", result.list},
               {"preset", to_string(result.options.preset)},
               {"strategy", to_string(result.options.strategy)},
               {"plpp", result.options.plpp},
               {"cycles", result.cycles}};
  add_measures(json, runs_of(result), result.arms);
  json["per_query"] = Json::object();
  for (const std::string& query : query_names(result)) {
    add_measures(json["per_query"][query], runs_of(result, query), result.arms);
  }
  // Names come from files of any encoding; a result is worth more than a broken letter in it.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tandem::io
