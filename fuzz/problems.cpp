#include "support.h"
#include "tandem/io/problem_file.h"
#include "tandem/world/workcell.h"

namespace tandem::fuzz {
namespace {

/// Robots for either kind of file: the model is the same, whatever the file calls it.
struct RobotFiles {
  RobotFiles() {
    robots.urdf[""] = folder.write("arm.urdf", kArmUrdf);
    robots.srdf[""] = folder.write("arm.srdf", kArmSrdf);
  }
  Folder folder;
  io::ProblemRobots robots;
};

void check(const std::vector<pipeline::BenchProblem>& problems) {
  constexpr std::size_t kMost = 3;  // Cells that are made; the others differ in numbers only.
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const pipeline::BenchProblem& problem = problems[i];
    require(problem.ends.start.size() == problem.ends.goal.size(), "both ends are of one cell");
    require(problem.ends.start.allFinite() && problem.ends.goal.allFinite(), "ends are finite");
    if (i >= kMost) continue;
    const auto made = problem.cell();
    const auto* cell = accepted(made);
    if (cell) require((*cell)->dof() == problem.ends.start.size(), "ends fit their cell");
  }
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::RobotFiles files;
  const auto file = files.folder.write("problems.json", fuzz::text_of(data, size));
  const auto problems = io::load_problems(file, files.robots);
  if (const auto* read = fuzz::accepted(problems)) fuzz::check(*read);
  return 0;
}
