#include "tandem/io/bench_file.h"
#include "tandem/io/bench_measures.h"
#include "tandem/io/table.h"

namespace tandem::io {

using pipeline::Statistics;

namespace {

void add_row(Table& table, const std::string& name, const Statistics& s, int decimals) {
  std::vector<std::string> cells = {name};
  for (const double value : {s.mean, s.std, s.p50, s.p95, s.p99, s.max}) {
    cells.push_back(Table::number(value, decimals));
  }
  table.row(std::move(cells));
}

std::string count_of(std::size_t count, const std::string& what, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? what : many);
}

std::string heading(const pipeline::BenchResult& result, const Runs& runs) {
  const std::size_t good = successes(runs).size();
  const double rate =
      runs.empty() ? 0.0 : 100.0 * static_cast<double>(good) / static_cast<double>(runs.size());
  return "workcell " + result.workcell + (result.list.empty() ? "" : ", list " + result.list) +
         ", preset " + to_string(result.options.preset) + ", strategy " +
         to_string(result.options.strategy) + ", seed " + std::to_string(result.options.seed) +
         "\n" + count_of(static_cast<std::size_t>(result.cycles), "whole cycle", "whole cycles") +
         ", " + count_of(runs.size(), "query", "queries") + ", " + std::to_string(good) +
         " successful (" + Table::number(rate, 1) + " %)\n";
}

std::string measures(const pipeline::BenchResult& result, const Runs& runs) {
  Table table;
  table.row({"successful runs", "mean", "std", "p50", "p95", "p99", "max"});
  for (const auto& [key, member] : kTimeKeys) {
    add_row(table, std::string(key) + " [ms]", measure_ms(runs, member), 3);
    for (std::size_t i = 0; has_arm_times(runs) && i < result.arms.size(); ++i) {
      if (member == &pipeline::ModuleTimes::coordination) break;  // Of all arms together.
      add_row(table, "  " + result.arms[i], measure_arm_ms(runs, member, static_cast<int>(i)), 3);
    }
  }
  add_row(table, "motion duration [s]", measure_duration(runs), 3);
  for (const auto& [key, member] : kLengthKeys) {
    add_row(table, key, measure_length(runs, member), 3);
    for (std::size_t i = 0; result.arms.size() > 1 && i < result.arms.size(); ++i) {
      add_row(table, "  " + result.arms[i], measure_length(runs, member, static_cast<int>(i)), 3);
    }
  }
  return table.text();
}

std::string counts_line(const std::string& title, const std::map<std::string, int>& counts) {
  std::string line;
  for (const auto& [name, count] : counts) {
    line += (line.empty() ? " " : ", ") + name + " " + std::to_string(count);
  }
  return title + ":" + (line.empty() ? " none" : line) + "\n";
}

std::string per_query(const pipeline::BenchResult& result) {
  Table table;
  table.row({"query", "runs", "failed", "total p50 [ms]", "total max [ms]", "motion mean [s]"});
  for (const std::string& query : query_names(result)) {
    const Runs runs = runs_of(result, query);
    const Statistics total = measure_ms(runs, &pipeline::ModuleTimes::total);
    table.row({query, std::to_string(runs.size()),
               std::to_string(runs.size() - successes(runs).size()), Table::number(total.p50, 3),
               Table::number(total.max, 3), Table::number(measure_duration(runs).mean, 3)});
  }
  return table.text();
}

}  // namespace

std::string bench_table(const pipeline::BenchResult& result) {
  const Runs runs = runs_of(result);
  return heading(result, runs) + "\n" + measures(result, runs) + "\n" +
         counts_line("failures", failures_by_kind(runs)) + counts_line("rungs", rung_counts(runs)) +
         "\n" + per_query(result);
}

}  // namespace tandem::io
