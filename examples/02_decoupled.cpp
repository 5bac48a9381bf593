// Each arm planned alone, on a thread of its own, then their motions coordinated; the same query
// with all arms planned together, and as `auto` would have it.

#include <iostream>

#include "tandem/tandem.h"

int main() {
  const auto cell = tandem::load_workcell("scenarios/gearbox/workcell.yaml");
  if (!cell) return std::cerr << cell.error().message << "\n", 1;
  const tandem::Planner planner(*cell);
  const tandem::world::Query& query = (*cell)->query("pick_gears");
  for (const auto strategy :
       {tandem::Strategy::kDecoupled, tandem::Strategy::kCentralized, tandem::Strategy::kAuto}) {
    const auto plan = planner.plan(query, {.strategy = strategy, .deadline = 10.0});
    if (!plan) return std::cerr << plan.error().message << "\n", 1;
    std::cout << to_string(strategy) << ": a motion of " << plan->trajectory.duration()
              << " s, planned in " << 1e3 * plan->report.times.total << " ms, of which "
              << 1e3 * plan->report.times.coordination << " ms for coordination; rungs:";
    for (const auto& [rung, count] : plan->report.rungs) std::cout << " " << rung;
    std::cout << "\n";
    // With the arms apart, each has a motion of its own and runs it at local times c(t).
    for (std::size_t i = 0; i < plan->report.arm_times.size(); ++i) {
      const tandem::motion::ArmMotion& arm = plan->trajectory.arms()[i];
      std::cout << "  " << (*cell)->arms()[i].name << " alone: " << arm.spline().duration()
                << " s, planned in " << 1e3 * plan->report.arm_times[i].total << " ms\n";
    }
  }
}
