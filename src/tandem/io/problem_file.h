#pragma once
/// Files of planning problems, as benchmarks of planners use them. The schemas are
/// docs/problems.md.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tandem/pipeline/problem_bench.h"

namespace tandem::io {

/// The robots that a problem file only names.
struct ProblemRobots {
  /// By model name as in the file ("panda"); an entry "" serves the only model there is.
  std::map<std::string, std::filesystem::path> urdf, srdf;
  std::vector<std::filesystem::path> packages;  ///< For package:// URIs.
  /// Values of joints that the problems do not move [rad or m]; others stand at 0.
  std::map<std::string, double> joints;
};

/// Reads a file of either kind: sets of problems of one robot, or poses of several robots in one
/// scene and pairs of them. Robots and arms are made once and shared.
///
/// Arms: the joints that the file moves, split where the kinematic tree branches; of each branch
/// the SRDF group with just these joints, or the chain of links. The file's position limits hold.
/// Joints to which the URDF gives no velocity or acceleration limit get kAssumedVelocity and
/// kAssumedAcceleration: a cell needs some, planning a path none.
/// @return kNotFound, kIo or kInvalidInput with file, line, column, key, value and remedy.
Result<std::vector<pipeline::BenchProblem>> load_problems(const std::filesystem::path& file,
                                                          const ProblemRobots& robots);

inline constexpr double kAssumedVelocity = 1.0;       // [rad/s or m/s]
inline constexpr double kAssumedAcceleration = 10.0;  // [rad/s^2 or m/s^2]

}  // namespace tandem::io
