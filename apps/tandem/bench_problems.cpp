#include "bench_problems.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>

#include "commands.h"
#include "stop_signals.h"
#include "tandem/core/names.h"
#include "tandem/io/plan_file.h"
#include "tandem/io/problem_bench_file.h"
#include "tandem/io/problem_file.h"

namespace tandem::app {

namespace {

using Problems = std::vector<pipeline::BenchProblem>;

/// "MODEL=FILE" or "FILE", as a key and a value; the key of the second is "".
std::pair<std::string, std::string> split(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {"", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Result<void> add_files(const std::vector<std::string>& given, const std::string& option,
                       std::map<std::string, std::filesystem::path>& files) {
  for (const std::string& text : given) {
    const auto [model, file] = split(text);
    if (files.emplace(model, file).second) continue;
    return fail(ErrorCode::kInvalidInput,
                option + (model.empty() ? " gives two files without a model; write MODEL=FILE"
                                        : " gives model '" + model + "' two files; keep one"));
  }
  return {};
}

Result<io::ProblemRobots> robots_of(const ProblemOptions& options,
                                    const std::vector<std::string>& packages) {
  io::ProblemRobots robots;
  robots.packages.assign(packages.begin(), packages.end());
  if (auto added = add_files(options.urdf, "--urdf", robots.urdf); !added) {
    return std::unexpected(added.error());
  }
  if (auto added = add_files(options.srdf, "--srdf", robots.srdf); !added) {
    return std::unexpected(added.error());
  }
  for (const std::string& text : options.joints) {
    const auto [name, number] = split(text);
    double value = 0;
    const char* const end = number.data() + number.size();
    const auto parsed = std::from_chars(number.data(), end, value);
    if (name.empty() || parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value)) {
      return fail(ErrorCode::kInvalidInput,
                  "--joint is '" + text + "', expected NAME=VALUE with a number [rad or m]");
    }
    robots.joints[name] = value;
  }
  return robots;
}

/// Keeps the problems of `sets`, or all if it is empty.
Result<void> select(const std::vector<std::string>& sets, Problems& problems) {
  if (sets.empty()) return {};
  std::vector<std::string> known;
  for (const pipeline::BenchProblem& problem : problems) {
    if (known.empty() || known.back() != problem.set) known.push_back(problem.set);
  }
  for (const std::string& set : sets) {
    if (std::ranges::find(known, set) != known.end()) continue;
    return fail(ErrorCode::kNotFound, "there is no set '" + set + "'" + name_hint(set, known));
  }
  std::erase_if(problems, [&sets](const pipeline::BenchProblem& problem) {
    return std::ranges::find(sets, problem.set) == sets.end();
  });
  return {};
}

Result<Problems> load(const ProblemOptions& options, const std::vector<std::string>& packages) {
  const auto robots = robots_of(options, packages);
  if (!robots) return std::unexpected(robots.error());
  auto problems = io::load_problems(options.file, *robots);
  if (!problems) return problems;
  if (auto selected = select(options.sets, *problems); !selected) {
    return std::unexpected(selected.error());
  }
  return problems;
}

}  // namespace

CLI::Option* ProblemOptions::add_to(CLI::App& command) {
  const char* group = "Problem files";
  CLI::Option* given =
      command.add_option("--problems", file, "Instead of a workcell: a file of planning problems")
          ->type_name("FILE")
          ->group(group);
  const auto add = [&](const char* name, std::vector<std::string>& values, const char* help,
                       const char* type) {
    command.add_option(name, values, help)
        ->type_name(type)
        ->allow_extra_args(false)
        ->needs(given)
        ->group(group);
  };
  add("--urdf", urdf, "Robot that the file names, or one per model; repeatable", "[MODEL=]FILE");
  add("--srdf", srdf, "Its groups and disabled pairs; repeatable", "[MODEL=]FILE");
  add("--joint", joints, "Value of a joint that the problems do not move; repeatable",
      "NAME=VALUE");
  add("--set", sets, "Only this set of the file; repeatable", "NAME");
  command.add_flag("--verbose", verbose, "List each failed run and why")
      ->needs(given)
      ->group(group);
  return given;
}

int bench_problems(const ProblemOptions& options, const std::vector<std::string>& packages,
                   int cycles, const PlanningOptions& planning, const BenchOutput& output) {
  const auto failed = [](const Error& error) { return report("bench", error); };
  const StopSignals signals;
  const auto problems = load(options, packages);
  if (!problems) return failed(problems.error());
  BenchProgress progress;
  const auto result = pipeline::bench_problems(
      *problems, cycles, planning.with(signals.token()),
      [&](const pipeline::ProblemRun& run, std::size_t done, std::size_t total) {
        progress.show(run.certified, run.problem, done, total);
      });
  progress.clear();
  if (!result) return failed(result.error());
  if (!output.json.empty()) {
    auto written = io::write_file(output.json, io::problem_bench_json(*result), output.force);
    if (!written) return failed(written.error());
  }
  const int printed = print("bench", io::problem_bench_table(*result, options.verbose));
  if (result->runs.size() < result->planned_runs) {
    std::cerr << "tandem bench: interrupted after " << result->runs.size() << " of "
              << result->planned_runs << " runs" << std::endl;
    return kInterrupted;
  }
  return printed;
}

void BenchProgress::show(bool success, const std::string& name, std::size_t done,
                         std::size_t total) {
  if (!shows_progress()) return;
  failed_ += success ? 0 : 1;
  std::cerr << "\r\033[K" << done << "/" << total << ", " << failed_ << " failed, " << name
            << std::flush;
}

void BenchProgress::clear() const {
  if (shows_progress()) std::cerr << "\r\033[K" << std::flush;
}

}  // namespace tandem::app
