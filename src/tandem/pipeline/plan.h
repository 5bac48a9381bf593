#pragma once
/// From a query to a proven trajectory: the public face of planning.

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "tandem/coordination/interpolation.h"
#include "tandem/core/result.h"
#include "tandem/core/stop.h"
#include "tandem/motion/cell_motion.h"
#include "tandem/motion/joint_path.h"
#include "tandem/pipeline/report.h"
#include "tandem/world/workcell.h"

namespace tandem::pipeline {

enum class Strategy {
  kCentralized,  ///< One composite robot. Ref: the paper, "Centralized Planning".
  /// Each arm alone, then their motions coordinated. Ref: the paper, "Decoupled Planning with
  /// Fixed-Path Coordination".
  kDecoupled,
  kAuto,  ///< Decoupled where the arms hardly hinder each other, centralized where they do.
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
  double deadline = 5.0;  ///< [s] of wall time, > 0; to resolve a query, and again to plan it.
  std::stop_token token = {};
  /// Of local times, with Strategy::kDecoupled and Preset::kPaper.
  coordination::Interpolation interpolation = coordination::Interpolation::kCubic;
  bool plpp = true;         ///< Shorten the tools' paths (the path length post-processor).
  bool keep_phases = true;  ///< Keep the intermediate paths in the report.
};

/// A query with joint values at both ends.
struct ResolvedQuery {
  std::string name;
  Eigen::VectorXd start, goal;  ///< Of the cell's q [rad or m].
  /// As it stands during the motion, after what the queries before and this one attached and
  /// detached; null: as the caller gives it.
  std::shared_ptr<const world::Workcell> cell = {};
};

struct Plan {
  std::string query;
  Strategy strategy;
  Preset preset;
  std::uint64_t seed;
  bool plpp;           ///< Whether the path length post-processor was part of it.
  ResolvedQuery ends;  ///< With the cell that was planned in.
  motion::CellMotion trajectory;
  PlanReport report;
};

/// A path without timing: waypoints with straight edges between them.
struct PathPlan {
  motion::JointPath planned;  ///< As the planner found it.
  motion::JointPath path;     ///< Simplified.
};

/// Joint values of a query's ends and the cell of its motion: named states looked up, poses solved
/// by inverse kinematics with collision-free solutions only, missing starts taken from the goal of
/// the query before, objects attached and detached by all queries of its list up to it. A query of
/// the cell starts from the cell's file; any other, from the cell as it is given.
/// @return kInfeasible or kNotFound naming the query, arm, pose and reason; the stop's error.
Result<ResolvedQuery> resolve(const std::shared_ptr<const world::Workcell>& cell,
                              const world::Query& query, std::uint64_t seed = 1,
                              const StopCondition& stop = {});

/// Queries that follow each other, the first from the cell's file. Same errors.
Result<std::vector<ResolvedQuery>> resolve_all(const std::shared_ptr<const world::Workcell>& cell,
                                               const std::vector<world::Query>& queries,
                                               std::uint64_t seed = 1,
                                               const StopCondition& stop = {});

/// kInfeasible naming the joint or the touching pair and depth if an end cannot be stood at.
/// @param cell  for a query without a cell of its own, here and below.
Result<void> check_ends(const world::Workcell& cell, const ResolvedQuery& query);

/// Plans one query; for many of one cell a Planner compiles it once. What is returned passed the
/// continuous-time certificate and the exact limit check; with Preset::kPaper it passed them
/// without repair, or it is an error.
/// @param report  if given, filled with times and counts even when planning fails.
/// @return kInfeasible, kNoPath, kCollision (pair, time, depth), kLimits, kTimeout, kCancelled.
/// Thread-safe. Equal seeds give equal plans.
Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const world::Query& query,
                  const PlanOptions& options = {}, PlanReport* report = nullptr);
Result<Plan> plan(const std::shared_ptr<const world::Workcell>& cell, const ResolvedQuery& query,
                  const PlanOptions& options = {}, PlanReport* report = nullptr);

/// The path of one query, all arms as one robot: planning and simplification alone, so velocities
/// and accelerations do not matter. With Preset::kDefault every edge passed the continuous-time
/// certificate, with kPaper samples of it are free: ask certify_path.
/// @param report  as in `plan`: checking the ends counts as path planning; phases are not kept.
/// @return kInfeasible naming the end and the joint or touching pair, kNoPath, kTimeout,
/// kCancelled. Thread-safe. Equal seeds give equal paths.
Result<PathPlan> plan_path(const std::shared_ptr<const world::Workcell>& cell,
                           const ResolvedQuery& query, const PlanOptions& options = {},
                           PlanReport* report = nullptr);

/// The distance [m] that every pair keeps along every edge, a lower bound; padding included.
/// @return kCollision naming edge, pair and depth if an edge is not free or cannot be proven to be;
/// kCancelled.
Result<double> certify_path(const std::shared_ptr<const world::Workcell>& cell,
                            const motion::JointPath& path, const std::stop_token& token = {});

}  // namespace tandem::pipeline
