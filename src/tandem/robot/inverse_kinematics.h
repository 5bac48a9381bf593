#pragma once
/// Inverse kinematics on position level: damped Newton with restarts.

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "tandem/core/stop.h"
#include "tandem/robot/kinematics.h"

namespace tandem::robot {

struct IkProblem {
  const Model* model = nullptr;
  int link = -1;                                           ///< Link L that carries the tool.
  Eigen::Isometry3d X_LE = Eigen::Isometry3d::Identity();  ///< Tool frame in L.
  std::vector<int> columns;                                ///< Position entries that may move.
  Eigen::VectorXd positions;  ///< All positions; the seed in `columns`.
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();  ///< Goal.
};

struct IkOptions {
  double position_tolerance = 1e-6;     ///< [m]
  double orientation_tolerance = 1e-6;  ///< [rad]
  int restarts = 100;                   ///< Random seeds tried after the given one.
  int iterations = 80;                  ///< Newton steps per seed.
  std::uint64_t seed = 1;
};

/// Why a candidate is refused; empty if it is fine. Typically names the touching pair.
using IkValidity = std::function<std::string(const Eigen::VectorXd& positions)>;

/// Solves for `columns` inside their joint limits; the first restart is the seed itself, so the
/// solution nearest to it is preferred.
/// @return all positions; kInfeasible saying which: out of reach (by how much, from a bound on the
/// chain's reach or because no restart came near), blocked (with the reason of `validity` that was
/// met most often), or not found in the budget with the best residual; or the stop's error.
/// Ref: Nakamura, Hanafusa, Inverse kinematic solutions with singularity robustness, 1986.
Result<Eigen::VectorXd> solve_ik(const IkProblem& problem, const IkOptions& options = {},
                                 const IkValidity& validity = {}, const StopCondition& stop = {});

}  // namespace tandem::robot
