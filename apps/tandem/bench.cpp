#include "tandem/pipeline/bench.h"

#include <iostream>
#include <map>

#include "bench_problems.h"
#include "commands.h"
#include "options.h"
#include "stop_signals.h"
#include "tandem/io/bench_file.h"
#include "tandem/io/plan_file.h"

namespace tandem::app {

namespace {

struct BenchCommand {
  CellOptions cell;
  PlanningOptions planning;
  ProblemOptions problems;
  BenchOutput output;
  int cycles = 1;
  std::string list;
};

/// One message per query and kind of failure: a thousand runs fail in few ways.
void print_failures(const pipeline::BenchResult& result) {
  std::map<std::pair<std::string, ErrorCode>, std::pair<const pipeline::BenchRun*, int>> kinds;
  for (const pipeline::BenchRun& run : result.runs) {
    if (run.success) continue;
    auto& [first, count] = kinds[{run.query, run.failure}];
    if (count++ == 0) first = &run;
  }
  for (const auto& [kind, example] : kinds) {
    std::cerr << "tandem bench: " << kind.first << " failed " << example.second
              << (example.second == 1 ? " time" : " times") << " by " << to_string(kind.second)
              << ", e.g. in cycle " << example.first->cycle << ": " << example.first->message
              << std::endl;
  }
}

int bench_cell(const BenchCommand& command) {
  const auto failed = [](const Error& error) { return report("bench", error); };
  const StopSignals signals;
  const auto cell = command.cell.load();
  if (!cell) return failed(cell.error());
  BenchProgress progress;
  const auto show = [&progress](const pipeline::BenchRun& run, int done, int total) {
    progress.show(run.success, run.query, static_cast<std::size_t>(done),
                  static_cast<std::size_t>(total));
  };
  const auto result = pipeline::bench(*cell, command.cycles, command.planning.with(signals.token()),
                                      show, command.list);
  progress.clear();
  if (!result) return failed(result.error());
  if (const BenchOutput& output = command.output; !output.json.empty()) {
    auto written = io::write_file(output.json, io::bench_json(*result), output.force);
    if (!written) return failed(written.error());
  }
  const int printed = print("bench", io::bench_table(*result));
  print_failures(*result);
  if (result->cycles < command.cycles) {
    std::cerr << "tandem bench: interrupted after " << result->runs.size() << " runs" << std::endl;
    return kInterrupted;
  }
  return printed;
}

int run(const BenchCommand& command) {
  if (const BenchOutput& output = command.output; !output.json.empty()) {
    auto writable = io::check_writable(output.json, output.force);
    if (!writable) return report("bench", writable.error());
  }
  if (command.problems.file.empty()) return bench_cell(command);
  return bench_problems(command.problems, command.cell.packages, command.cycles, command.planning,
                        command.output);
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand(
      "bench", "Plan all queries of a workcell again and again, or a file of problems");
  auto command = std::make_shared<BenchCommand>();
  CLI::Option* cell = command->cell.add_to(*sub)->required(false);
  cell->excludes(command->problems.add_to(*sub));
  sub->add_option("--cycles", command->cycles, "How often each query or problem is planned")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(1));
  CLI::Option* list = sub->add_option("--list", command->list,
                                      "Which of the workcell's lists; without it, its queries");
  list->type_name("NAME")->needs(cell);
  sub->add_option("--json", command->output.json, "Write the statistics here")->type_name("FILE");
  add_force(*sub, command->output.force);
  command->planning.add_to(*sub);
  sub->footer(
      "Prints a table: mean, deviation, percentiles and maximum per module, failures by kind, the\n"
      "fallbacks taken, and a row per query. Statistics are over successful runs. Run k has seed\n"
      "SEED + k. Interrupted, it keeps what it has.\n\n"
      "With --problems, only paths are planned, without timing: per set, how many problems were\n"
      "solved, how many paths are certified, planning and simplification times in microseconds\n"
      "and lengths before and after. See docs/problems.md.\n\n"
      "Example:\n"
      "  tandem bench scenarios/gearbox/workcell.yaml --cycles 100 --preset paper --json "
      "paper.json\n\n"
      "Exit codes: 0 all cycles were run (failed queries are a result), 1 a query cannot be stood\n"
      "at, 2 options or files that cannot be used, 130 interrupted.");
  sub->callback([command, &exit_code] {
    if (command->cell.file.empty() && command->problems.file.empty()) {
      throw CLI::RequiredError("CELL or --problems");
    }
    exit_code = run(*command);
  });
}

}  // namespace tandem::app
