#include <algorithm>

#include "commands.h"
#include "options.h"
#include "stop_signals.h"
#include "tandem/collision/compiled_cell.h"
#include "tandem/core/names.h"
#include "tandem/io/diagram_file.h"
#include "tandem/io/plan_file.h"
#include "tandem/io/table.h"

namespace tandem::app {

namespace {

struct PlanCommand {
  CellOptions cell;
  PlanningOptions planning;
  std::string query, output, csv, diagram;
  std::vector<std::string> diagram_arms;
  double rate = 1000;
  bool json = false, force = false;
};

Result<void> check_outputs(const PlanCommand& command) {
  if (!command.output.empty() && command.output == command.csv) {
    return fail(ErrorCode::kInvalidInput, "-o and --csv name the same file, " + command.csv);
  }
  for (const std::string& file : {command.output, command.csv, command.diagram}) {
    if (file.empty()) continue;
    if (auto writable = io::check_writable(file, command.force); !writable) return writable;
  }
  return {};
}

/// Where the arms are on their own motions while they run together: a schedule for the figure.
coordination::Schedule sampled(const motion::CellMotion& motion) {
  constexpr int kSamples = 500;
  coordination::Schedule schedule;
  const auto arms = static_cast<Eigen::Index>(motion.arms().size());
  for (int k = 0; k <= kSamples; ++k) {
    const double t = motion.duration() * k / kSamples;
    Eigen::VectorXd place(arms);
    for (Eigen::Index i = 0; i < arms; ++i) {
      const motion::ArmMotion& arm = motion.arms()[static_cast<std::size_t>(i)];
      const double own = arm.map() ? (*arm.map())(t) : t;
      place[i] = std::clamp(own, 0.0, arm.spline().duration());
    }
    if (!schedule.places.empty() && place == schedule.places.back()) continue;
    schedule.places.push_back(std::move(place));
    schedule.times.push_back(t);
  }
  return schedule;
}

/// The arms of the diagram by their names: those given, or the first two.
Result<std::pair<int, int>> arms_of_diagram(const PlanCommand& command,
                                            const world::Workcell& cell) {
  if (cell.arms().size() < 2) {
    return fail(ErrorCode::kInvalidInput,
                "--diagram needs a cell of two arms; '" + cell.name() + "' has one");
  }
  std::vector<std::string> names;
  for (const world::Arm& arm : cell.arms()) names.push_back(arm.name);
  std::vector<int> found{0, 1};
  for (std::size_t i = 0; i < command.diagram_arms.size(); ++i) {
    const std::string& name = command.diagram_arms[i];
    found[i] = cell.find_arm(name);
    if (found[i] >= 0) continue;
    return fail(ErrorCode::kNotFound,
                "--arms: '" + cell.name() + "' has no arm '" + name + "'" + name_hint(name, names));
  }
  if (found[0] == found[1]) {
    return fail(ErrorCode::kInvalidInput,
                "--arms names '" + command.diagram_arms[0] + "' twice; a diagram is of two arms");
  }
  return std::pair(found[0], found[1]);
}

/// The diagram of two arms.
Result<void> save_diagram(const PlanCommand& command, const pipeline::Plan& plan,
                          const std::shared_ptr<const world::Workcell>& given) {
  if (command.diagram.empty()) return {};
  const auto cell = plan.ends.cell ? plan.ends.cell : given;
  const auto arms = arms_of_diagram(command, *cell);
  if (!arms) return std::unexpected(arms.error());
  const collision::CompiledCell compiled(cell);
  coordination::CoordinationProblem problem{compiled, {}};
  for (const motion::ArmMotion& arm : plan.trajectory.arms()) {
    problem.arms.push_back(arm.spline());
  }
  const auto drawing =
      coordination::draw_diagram(problem, arms->first, arms->second, {sampled(plan.trajectory)});
  if (!drawing) return std::unexpected(drawing.error());
  return io::save_diagram(command.diagram, *drawing, *cell, plan.query, command.force);
}

Result<void> save(const PlanCommand& command, const pipeline::Plan& plan,
                  const world::Workcell& cell) {
  if (!command.output.empty()) {
    auto saved = io::save_plan(command.output, plan, cell, command.force);
    if (!saved) return saved;
  }
  if (command.csv.empty()) return {};
  return io::save_csv(command.csv, plan.trajectory, cell.joint_names(), command.rate,
                      command.force);
}

std::string summary(const PlanCommand& command, const pipeline::Plan& plan) {
  const pipeline::PlanReport& report = plan.report;
  io::Table table;
  const auto add = [&](const std::string& name, double value, int decimals, const char* unit) {
    table.row({name, io::Table::number(value, decimals), unit});
  };
  add("path planning", report.times.path_planning * 1e3, 3, "ms");
  add("simplification", report.times.simplification * 1e3, 3, "ms");
  add("trajectory", report.times.trajectory * 1e3, 3, "ms");
  add("coordination", report.times.coordination * 1e3, 3, "ms");
  add("certificate", report.times.certificate * 1e3, 3, "ms");
  add("total", report.times.total * 1e3, 3, "ms");
  add("motion duration", plan.trajectory.duration(), 3, "s");
  add("least clearance", report.least_clearance * 1e3, 3, "mm");
  std::string text = "query " + plan.query + ", preset " + to_string(plan.preset) + ", strategy " +
                     to_string(plan.strategy) + ", seed " + std::to_string(plan.seed) + "\n" +
                     table.text();
  std::string rungs;
  for (const auto& [rung, count] : report.rungs) {
    rungs += (rungs.empty() ? "" : ", ") + rung + " " + std::to_string(count);
  }
  text += "rungs: " + (rungs.empty() ? "none" : rungs) + "\n";
  for (const std::string& file : {command.output, command.csv, command.diagram}) {
    if (!file.empty()) text += "written: " + file + "\n";
  }
  return text;
}

int run(const PlanCommand& command) {
  const auto failed = [](const Error& error) { return report("plan", error); };
  if (auto writable = check_outputs(command); !writable) return failed(writable.error());
  const StopSignals signals;
  const auto cell = command.cell.load();
  if (!cell) return failed(cell.error());
  const auto query = (*cell)->find_query(command.query);
  if (!query) return failed(query.error());
  if (!command.diagram.empty()) {
    if (auto arms = arms_of_diagram(command, **cell); !arms) return failed(arms.error());
  }
  const auto plan = pipeline::plan(*cell, **query, command.planning.with(signals.token()));
  if (!plan) return failed(plan.error());
  if (auto saved = save(command, *plan, **cell); !saved) return failed(saved.error());
  if (auto saved = save_diagram(command, *plan, *cell); !saved) return failed(saved.error());
  if (!command.json) return print("plan", summary(command, *plan));
  const std::string file = command.output.empty() ? "plan.json" : command.output;
  const auto json = io::plan_json(*plan, **cell, file);
  return json ? print("plan", *json) : failed(json.error());
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand("plan", "Plan one query of a workcell");
  auto command = std::make_shared<PlanCommand>();
  command->cell.add_to(*sub);
  sub->add_option("QUERY", command->query, "Name of the query, or LIST/QUERY")
      ->required()
      ->type_name("");
  sub->add_option("-o,--output", command->output, "Write the plan here (JSON)")->type_name("FILE");
  auto* csv = sub->add_option("--csv", command->csv, "Write samples of the motion here");
  csv->type_name("FILE");
  sub->add_option("--rate", command->rate, "Samples per second in the CSV file, needs --csv")
      ->type_name("HZ")
      ->capture_default_str()
      ->check(positive_number(kHighestRate))
      ->needs(csv);
  auto* diagram = sub->add_option(
      "--diagram", command->diagram,
      "Write the coordination diagram of two arms here: what is blocked, and the motion's\n"
      "way (JSON; .csv: cells, and lines beside them)");
  diagram->type_name("FILE");
  sub->add_option("--arms", command->diagram_arms,
                  "The arms of the diagram, the one along x first; default: the first two")
      ->type_name("X,Y")
      ->delimiter(',')
      ->expected(2)
      ->needs(diagram);
  sub->add_flag("--json", command->json, "Print the plan file instead of a table");
  add_force(*sub, command->force);
  command->planning.add_to(*sub);
  sub->footer(
      "Prints module times, duration, clearance and the fallbacks taken. A plan is only returned\n"
      "after the executed curve passed the collision certificate and the limit check.\n\n"
      "Example:\n"
      "  tandem plan scenarios/gearbox/workcell.yaml pick_gears -o plan.json --csv plan.csv\n\n"
      "Exit codes: 0 planned, 1 no plan (the message says why), 2 options or files that cannot\n"
      "be used, 130 interrupted.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace tandem::app
