#include <algorithm>
#include <iostream>

#include "check_report.h"
#include "commands.h"
#include "options.h"
#include "stop_signals.h"
#include "tandem/io/moveit_scene.h"
#include "tandem/io/plan_file.h"
#include "tandem/pipeline/planner.h"

namespace tandem::app {

namespace {

struct CheckCommand {
  CellOptions cell;
  std::uint64_t seed = 1;
  int samples = 10'000;
  bool pairs = false, suggest = false, json = false;
  std::string scene;
  bool force = false;
};

using Cell = std::shared_ptr<const world::Workcell>;

Result<QueryCheck> check_query(const pipeline::Planner& planner, const world::Query& query,
                               std::uint64_t seed, const StopCondition& stop) {
  QueryCheck check;
  check.name = query.name;
  auto resolved = planner.resolve(query, seed, stop);
  if (!resolved) {
    if (stop()) return std::unexpected(resolved.error());
    check.reason = resolved.error().message;
    return check;
  }
  check.ends = std::move(*resolved);
  const auto compiled = planner.compiled(check.ends->cell);
  check.start = pipeline::examine(compiled->exact(), check.ends->start);
  check.goal = pipeline::examine(compiled->exact(), check.ends->goal);
  return check;
}

/// One proposal per robot description: robots that share one share its SRDF.
int suggest(const CheckCommand& command, const world::Workcell& cell, std::stop_token token) {
  collision::SuggestionOptions options;
  options.samples = command.samples;
  options.seed = command.seed;
  options.stop = StopCondition::after(std::numeric_limits<double>::infinity(), token);
  std::vector<RobotSuggestion> all;
  for (const world::RobotSpec& robot : cell.spec().robots) {
    const bool known = std::ranges::any_of(all, [&](const RobotSuggestion& other) {
      return !robot.urdf.empty() && other.robot->urdf == robot.urdf &&
             other.robot->srdf == robot.srdf;
    });
    if (known) continue;
    auto pairs = collision::suggest_disabled_pairs(robot, options);
    if (!pairs) return report("check", pairs.error());
    all.push_back({&robot, std::move(*pairs)});
  }
  return print("check", command.json ? suggestions_json(all, command.samples, command.seed)
                                     : suggestions_text(all, command.samples, command.seed));
}

/// Writes the obstacles as one of MoveIt's scenes, and says what it cannot say exactly.
Result<void> export_scene(const world::Workcell& cell, const CheckCommand& command) {
  const auto scene = io::moveit_scene_text(cell.name(), cell.spec().obstacles);
  if (!scene) return std::unexpected(scene.error());
  for (const std::string& note : scene->notes) {
    std::cerr << "tandem check: " << command.scene << ": " << note << std::endl;
  }
  return io::write_file(command.scene, scene->text, command.force);
}

int run(const CheckCommand& command) {
  const StopSignals signals;
  const auto loaded = command.cell.load();
  if (!loaded) return report("check", loaded.error());
  const Cell& cell = *loaded;
  if (!command.scene.empty()) {
    auto written = export_scene(*cell, command);
    if (!written) return report("check", written.error());
  }
  if (command.suggest) return suggest(command, *cell, signals.token());
  const pipeline::Planner planner(cell);
  std::vector<QueryCheck> queries;
  std::vector<world::Query> all = cell->queries();
  for (const world::QueryList& list : cell->lists()) {
    all.insert(all.end(), list.queries.begin(), list.queries.end());
  }
  const auto stop = StopCondition::after(std::numeric_limits<double>::infinity(), signals.token());
  for (const world::Query& query : all) {
    auto checked = check_query(planner, query, command.seed, stop);
    if (!checked) return report("check", checked.error());
    queries.push_back(std::move(*checked));
  }
  const int printed = print("check", command.json ? check_json(*cell, queries, command.pairs)
                                                  : check_text(*cell, queries, command.pairs));
  const auto bad =
      std::ranges::count_if(queries, [](const QueryCheck& query) { return !query.feasible(); });
  if (printed != kOk || bad == 0) return printed;
  std::cerr << "tandem check: " << bad << " of " << queries.size() << " queries are not feasible"
            << std::endl;
  return kFailed;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* sub =
      app.add_subcommand("check", "What is in a workcell, and which queries are feasible");
  auto command = std::make_shared<CheckCommand>();
  command->cell.add_to(*sub);
  sub->add_flag("--pairs", command->pairs, "List every pair of bodies, checked or skipped and why");
  sub->add_flag("--suggest-pairs", command->suggest,
                "Propose pairs of links that need no check, as lines of an SRDF, instead");
  sub->add_option("--samples", command->samples, "Configurations that --suggest-pairs looks at")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(1) & CLI::Range(1, 100'000'000));
  sub->add_option("--seed", command->seed,
                  "Of the inverse kinematics of pose goals, and of the samples")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(0));
  sub->add_flag("--json", command->json, "Print JSON instead of tables");
  sub->add_option("--export-scene", command->scene,
                  "Write the obstacles here as a MoveIt scene (.scene)")
      ->type_name("FILE");
  add_force(*sub, command->force);
  sub->footer(
      "Shows robots, arms, joints and their limits, bodies and their shapes, how many pairs are\n"
      "checked and why others are skipped, and for each query whether the cell can stand at its\n"
      "start and goal, with what the arms carry: inside the limits, in reach, free of collisions.\n"
      "If it cannot, every joint outside its limits and every touching pair is named, and by how\n"
      "much.\n\n"
      "--suggest-pairs is for robots without SRDF: the lines are a proposal for a person to "
      "review.\n\n"
      "Example:\n"
      "  tandem check scenarios/gearbox/workcell.yaml --pairs\n"
      "  tandem check cell.yaml --suggest-pairs > pairs.xml\n\n"
      "Exit codes: 0 every query is feasible, 1 one is not, 2 options or files that cannot be\n"
      "used, 130 interrupted.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace tandem::app
