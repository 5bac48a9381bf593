#pragma once
/// Cells that benchmarks and studies ask about, and the instruction sets they ask with.

#include <hwy/targets.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/io/problem_file.h"
#include "tandem/tandem.h"

namespace tandem::bench {

using Cell = std::shared_ptr<const world::Workcell>;

struct NamedCell {
  std::string name;
  Cell cell;
};

inline std::filesystem::path source_folder() { return TANDEM_SOURCE_DIR; }
/// Test data: TANDEM_DATA_DIR, else ../shared beside the sources.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("TANDEM_DATA_DIR");
  return folder ? std::filesystem::path(folder) : source_folder() / "../shared";
}

/// A workcell below scenarios/; throws std::bad_expected_access where it cannot be read.
inline NamedCell scenario(const std::string& name, const std::string& file) {
  return {name, load_workcell(source_folder() / "scenarios" / file).value()};
}

/// The first problem of every set of MotionBenchMaker's problems; none without the data.
/// @param model  "panda" or "baxter".
inline std::vector<NamedCell> problem_cells(const std::string& model) {
  const std::filesystem::path robots = data_folder() / "robots" / (model + "_mbm");
  io::ProblemRobots files;
  files.urdf[""] = robots / (model + "_spherized.urdf");
  files.srdf[""] = robots / (model + ".srdf");
  const auto problems =
      io::load_problems(data_folder() / "problems/mbm" / (model + ".json"), files);
  if (!problems) {
    std::fprintf(stderr, "left out: %s\n", problems.error().message.c_str());
    return {};
  }
  std::map<std::string, const pipeline::BenchProblem*> first;
  for (const pipeline::BenchProblem& problem : *problems) first.try_emplace(problem.set, &problem);
  std::vector<NamedCell> cells;
  for (const auto& [set, problem] : first) {
    cells.push_back({model + "_" + set, problem->cell().value()});
  }
  return cells;
}

/// Uniform inside the limits.
inline Eigen::VectorXd random_configuration(Rng& rng, const world::Workcell& cell) {
  Eigen::VectorXd q(cell.dof());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = rng.uniform(cell.lower()[j], cell.upper()[j]);
  return q;
}

/// Instruction sets that this machine and this build have.
inline std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> all;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    all.push_back(left & -left);
  }
  return all;
}
/// Kernels of this one from now on; 0: the best there is.
inline void use_target(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace tandem::bench
