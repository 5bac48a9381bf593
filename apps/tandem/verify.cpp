#include "tandem/verification/verify.h"

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "options.h"
#include "plan_input.h"
#include "stop_signals.h"
#include "tandem/io/table.h"

namespace tandem::app {

namespace {

struct VerifyCommand {
  std::string plan;
  CellOptions cell;  ///< Its file: instead of the one that the plan names.
  verification::VerifyOptions options;
  bool json = false;
};

std::string table(const verification::VerifyReport& r) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return std::string(text);
  };
  io::Table rows;
  rows.row({"samples", std::to_string(r.samples), ""});
  rows.row({"least clearance", number(r.least_clearance * 1e3), "mm"});
  if (!r.nearest_pair.empty()) rows.row({"  at", number(r.nearest_time), "s"});
  rows.row({"worst limit ratio", number(r.worst_limit_ratio), ""});
  rows.row({"largest jump of q", number(r.largest_jumps[0]), ""});
  rows.row({"largest jump of qd", number(r.largest_jumps[1]), ""});
  rows.row({"largest jump of qdd", number(r.largest_jumps[2]), ""});
  std::string text = rows.text();
  if (!r.nearest_pair.empty()) text += "nearest pair: " + r.nearest_pair + "\n";
  return text;
}

std::string as_text(const VerifyCommand& command, const io::PlanFile& plan,
                    const verification::VerifyReport& r) {
  std::string text = command.plan + ": query " + plan.query + ", " +
                     io::Table::number(plan.trajectory.duration(), 3) + " s\n" + table(r);
  for (const std::string& failure : r.failures) text += "failure: " + failure + "\n";
  return text + "verdict: " + (r.ok() ? "good" : "bad") + "\n";
}

std::string as_json(const VerifyCommand& command, const io::PlanFile& plan,
                    const verification::VerifyReport& r) {
  const nlohmann::ordered_json json = {
      {"plan", command.plan},
      {"query", plan.query},
      {"ok", r.ok()},
      {"rate_hz", command.options.rate},
      {"samples", r.samples},
      {"least_clearance_m", r.least_clearance},
      {"nearest_pair", r.nearest_pair},
      {"nearest_time_s", r.nearest_time},
      {"worst_limit_ratio", r.worst_limit_ratio},
      {"largest_jumps", {r.largest_jumps[0], r.largest_jumps[1], r.largest_jumps[2]}},
      {"failures", r.failures}};
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

int run(const VerifyCommand& command) {
  const auto failed = [](const Error& error) { return report("verify", error); };
  const StopSignals signals;
  const auto plan = io::load_plan(command.plan);
  if (!plan) return failed(plan.error());
  const auto cell = load_cell(command.cell, command.plan, *plan);
  if (!cell) return failed(cell.error());
  if (const std::string why = mismatch(*plan, **cell); !why.empty()) {
    std::cerr << "tandem verify: " << command.plan << ": " << why << std::endl;
    return kFailed;
  }
  const auto result = verification::verify(
      *cell, plan->trajectory, plan->start, plan->goal, command.options,
      StopCondition::after(std::numeric_limits<double>::infinity(), signals.token()));
  if (!result) return failed(result.error());
  const int printed = print(
      "verify", command.json ? as_json(command, *plan, *result) : as_text(command, *plan, *result));
  if (printed != kOk || result->ok()) return printed;
  std::cerr << "tandem verify: " << command.plan << " fails: " << result->failures.front();
  if (result->failures.size() > 1) {
    std::cerr << " (and " << result->failures.size() - 1 << " more)";
  }
  std::cerr << std::endl;
  return kFailed;
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand(
      "verify", "Check a plan file independently, by FCL on the URDF's own geometry");
  auto command = std::make_shared<VerifyCommand>();
  sub->add_option("PLAN", command->plan, "Plan file (JSON)")->required()->type_name("");
  sub->add_option("--rate", command->options.rate, "Samples per second")
      ->type_name("HZ")
      ->capture_default_str()
      ->check(positive_number(kHighestRate));
  sub->add_option("--workcell", command->cell.file, "Instead of the workcell that the plan names")
      ->type_name("FILE");
  command->cell.add_packages(*sub);
  sub->add_flag("--json", command->json, "Print JSON instead of a table");
  sub->footer(
      "Shares no code with the planner's proof: other geometry, other distances, samples instead\n"
      "of bounds. Checks collisions, joint limits, steps in position, velocity and acceleration,\n"
      "the ends of the motion, and that the plan's joints are the workcell's.\n\n"
      "Example:\n"
      "  tandem verify plan.json --rate 1000\n\n"
      "Exit codes: 0 the plan is good, 1 it is not (the reasons are printed), 2 options or files\n"
      "that cannot be used, 130 interrupted.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace tandem::app
