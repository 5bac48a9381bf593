#include <iostream>

#include "tandem/tandem.h"

int main() {
  const auto cell = tandem::load_workcell("scenarios/gearbox/workcell.yaml");
  if (!cell) return std::cerr << cell.error().message << "\n", 1;
  const auto plan = tandem::plan(*cell, (*cell)->query("pick_gears"), {.deadline = 10.0});
  if (!plan) return std::cerr << plan.error().message << "\n", 1;
  for (double t = 0; t <= plan->trajectory.duration(); t += 0.1) {
    const tandem::JointState s = plan->trajectory.at(t);  // q, qd, qdd, qddd of both arms
    std::cout << t << " s: " << s.q.transpose() << "\n";
  }
}
