#include <algorithm>
#include <iostream>

#include "check_report.h"
#include "commands.h"
#include "options.h"
#include "stop_signals.h"
#include "tandem/io/moveit_scene.h"
#include "tandem/io/plan_file.h"

namespace tandem::app {

namespace {

struct CheckCommand {
  CellOptions cell;
  std::uint64_t seed = 1;
  bool pairs = false, json = false;
  std::string scene;
  bool force = false;
};

QueryCheck check_query(const std::shared_ptr<const world::Workcell>& cell,
                       const world::Query& query, std::uint64_t seed) {
  const auto resolved = pipeline::resolve(cell, query, seed);
  if (!resolved) return {query.name, false, resolved.error().message};
  const auto ends = pipeline::check_ends(*cell, *resolved);
  if (!ends) return {query.name, false, ends.error().message};
  return {query.name, true, ""};
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
  const auto& cell = *loaded;
  if (!command.scene.empty()) {
    auto written = export_scene(*cell, command);
    if (!written) return report("check", written.error());
  }
  std::vector<QueryCheck> queries;
  std::vector<world::Query> all = cell->queries();
  for (const world::QueryList& list : cell->lists()) {
    all.insert(all.end(), list.queries.begin(), list.queries.end());
  }
  for (const world::Query& query : all) {
    if (signals.token().stop_requested()) {
      return report("check", {ErrorCode::kCancelled, "interrupted"});
    }
    queries.push_back(check_query(cell, query, command.seed));
  }
  const int printed = print("check", command.json ? check_json(*cell, queries, command.pairs)
                                                  : check_text(*cell, queries, command.pairs));
  const auto bad = std::count_if(queries.begin(), queries.end(),
                                 [](const QueryCheck& query) { return !query.feasible; });
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
  sub->add_option("--seed", command->seed, "Of the inverse kinematics of pose goals")
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
      "start and goal: inside the limits, in reach, free of collisions, with what the arms "
      "carry.\n\n"
      "Example:\n"
      "  tandem check scenarios/gearbox/workcell.yaml --pairs\n\n"
      "Exit codes: 0 every query is feasible, 1 one is not, 2 options or files that cannot be\n"
      "used, 130 interrupted.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace tandem::app
