#pragma once
/// What a plan cost and which fallbacks it took.

#include <map>
#include <string>
#include <vector>

#include "tandem/motion/joint_path.h"

namespace tandem::pipeline {

/// Wall time [s] per module; a module that did not run has 0. Where arms are planned at the same
/// time, that of the arm that took longest.
struct ModuleTimes {
  double path_planning = 0;
  double simplification = 0;
  double plpp = 0;
  double trajectory = 0;
  double coordination = 0;
  double certificate = 0;
  double distance = 0;  ///< Inside collision checks, a part of the modules above.
  double total = 0;

  ModuleTimes& operator+=(const ModuleTimes& more) {
    path_planning += more.path_planning;
    simplification += more.simplification;
    plpp += more.plpp;
    trajectory += more.trajectory;
    coordination += more.coordination;
    certificate += more.certificate;
    distance += more.distance;
    total += more.total;
    return *this;
  }
};

/// Calls per module.
struct ModuleCounts {
  long state_checks = 0;
  long edge_checks = 0;
  long certificate_evaluations = 0;
  long shortenings = 0;  ///< Runs of the path length post-processor.
  long timings = 0;      ///< Runs of the time optimiser.
  long repairs = 0;      ///< Waypoints added because the executed curve touched something.

  ModuleCounts& operator+=(const ModuleCounts& more) {
    state_checks += more.state_checks;
    edge_checks += more.edge_checks;
    certificate_evaluations += more.certificate_evaluations;
    shortenings += more.shortenings;
    timings += more.timings;
    repairs += more.repairs;
    return *this;
  }
};

/// Lengths of one arm's path, before and after shortening.
struct ArmLengths {
  double f_before = 0, f_after = 0;  ///< Ref: eq:PLPP_new, alpha 5.
  double L_before = 0, L_after = 0;
  double joint_length = 0;  ///< Of the final path [rad].
};

/// A named path on the way to the result: "planned", "simplified", ...
struct Phase {
  std::string name;
  motion::JointPath path;
};

struct PlanReport {
  ModuleTimes times;
  ModuleCounts counts;
  std::vector<ArmLengths> arms;
  std::vector<ModuleTimes> arm_times;  ///< Of each arm alone; empty if none was planned so.
  std::map<std::string, int> rungs;  ///< Fallbacks taken and how often: "repair", "rest_to_rest"...
  std::vector<Phase> phases;
  double least_clearance = 0;  ///< [m] certified, padding included; 0 if not certified.
};

}  // namespace tandem::pipeline
