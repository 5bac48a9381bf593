#pragma once
/// From a query to a proven trajectory: the public face of planning.

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "tandem/core/result.h"
#include "tandem/motion/piecewise_cubic.h"
#include "tandem/pipeline/report.h"
#include "tandem/world/workcell.h"

namespace tandem::pipeline {

enum class Strategy {
  kCentralized,  ///< One composite robot. Ref: the paper, "Centralized Planning".
};

enum class Preset {
  kDefault,  ///< The fastest that keeps the promises: certified edges, repair, certificate.
  kPaper,    ///< The paper's modules and parameters; nothing is repaired.
};

const char* to_string(Strategy strategy);
const char* to_string(Preset preset);

struct PlanOptions {
  Strategy strategy = Strategy::kCentralized;
  Preset preset = Preset::kDefault;
  std::uint64_t seed = 1;
  double deadline = 5.0;  ///< [s] of wall time, > 0.
  std::stop_token token = {};
  bool keep_phases = true;  ///< Keep the intermediate paths in the report.
};

/// A query with joint values at both ends.
struct ResolvedQuery {
  std::string name;
  Eigen::VectorXd start, goal;  ///< Of the cell's q [rad or m].
};

struct Plan {
  std::string query;
  Strategy strategy;
  Preset preset;
  std::uint64_t seed;
  ResolvedQuery ends;
  motion::CellMotion trajectory;
  PlanReport report;
};

/// Joint values of a query's ends: named states looked up, poses solved by inverse kinematics with
/// collision-free solutions only, missing starts taken from the goal of the query before.
/// @return kInfeasible or kNotFound naming the query, arm, pose and reason.
Result<ResolvedQuery> resolve(const std::shared_ptr<const world::Workcell>& cell,
                              const world::Query& query, std::uint64_t seed = 1);

/// kInfeasible naming the joint or the touching pair and depth if an end cannot be stood at.
Result<void> check_ends(const world::Workcell& cell, const ResolvedQuery& query);

/// Plans one query. What is returned passed the continuous-time certificate and the exact limit
/// check; with Preset::kPaper it passed them without repair, or it is an error.
/// @param report  if given, filled with times and counts even when planning fails.
/// @return kInfeasible, kNoPath, kCollision (pair, time, depth), kLimits, kTimeout, kCancelled.
/// Thread-safe. Equal seeds give equal plans.
Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const world::Query& query,
                  const PlanOptions& options = {}, PlanReport* report = nullptr);
Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const ResolvedQuery& query,
                  const PlanOptions& options = {}, PlanReport* report = nullptr);

}  // namespace tandem::pipeline
