#include "tandem/io/problem_file.h"

#include "tandem/io/problem_robots.h"

namespace tandem::io {

Result<std::vector<pipeline::BenchProblem>> load_problems(const std::filesystem::path& file,
                                                          const ProblemRobots& robots) {
  return read_json(file, [&](const JsonReader& root) {
    if (!root.has("sets") && !root.has("pairs")) {
      root.refuse("problems: an object with `sets` (of one robot) or `pairs` (of poses)");
    }
    return root.has("sets") ? read_problem_sets(root, robots) : read_pose_pairs(root, robots);
  });
}

}  // namespace tandem::io
